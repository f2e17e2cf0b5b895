#include "solver/response/rms_fields.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

using Eigen::Index;

void add_squares(std::vector<double>& sums, const std::vector<double>& steps) {
  for (std::size_t k = 0; k < steps.size(); ++k) sums[k % sums.size()] += steps[k] * steps[k];
}

} // namespace

FieldSamples rms_fields(const SolutionSpace& space, const ElasticMaterial& material, const SamplePoints& points,
                        const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  constexpr Index together = 8; // bounds the memory
  const std::size_t n = points.cell.size();
  FieldSamples rms{std::vector<double>(3 * n), std::vector<double>(6 * n), std::vector<double>(6 * n),
                   std::vector<double>(n)};
  for (Index first = 0; first < columns.cols(); first += together) {
    const Index count = std::min(together, columns.cols() - first);
    const FieldSamples some = sample_fields(space, material, points, columns.middleCols(first, count), Fields::All);
    add_squares(rms.displacement, some.displacement);
    add_squares(rms.strain, some.strain);
    add_squares(rms.stress, some.stress);
    add_squares(rms.von_mises, some.von_mises);
  }
  for (auto* field : {&rms.displacement, &rms.strain, &rms.stress, &rms.von_mises})
    for (double& value : *field) value = std::sqrt(value);
  return rms;
}

} // namespace iga::solve
