#include "solver/recover.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace iga::solve {

namespace {


class SpanRecovery {
 public:
  SpanRecovery(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u)
      : space_(space), material_(material), u_(u) {}

  void at(std::int64_t a, std::span<const double> parameters) {
    evaluate(space_, a, parameters, Shapes::Both, shapes_);
    const auto nodes = space_.nodes(a);
    const auto count = static_cast<Eigen::Index>(nodes.size()), n = shapes_.values.rows();
    coefficients_.resize(count, 3);
    for (Eigen::Index r = 0; r < count; ++r)
      coefficients_.row(r) = u_.segment<3>(3 * nodes[static_cast<std::size_t>(r)]).transpose();
    displacement_.noalias() = shapes_.values * coefficients_;
    gradient_.resize(n, 9);
    along_.resize(n, count);
    for (Eigen::Index d = 0; d < 3; ++d) {
      for (Eigen::Index r = 0; r < count; ++r) along_.col(r) = shapes_.gradients.col(3 * r + d);
      const Eigen::MatrixXd slope = along_ * coefficients_;
      for (Eigen::Index c = 0; c < 3; ++c) gradient_.col(3 * c + d) = slope.col(c);
    }
  }
  Eigen::Index size() const { return displacement_.rows(); }
  Eigen::Vector3d displacement(Eigen::Index q) const { return displacement_.row(q).transpose(); }
  Voigt strain(Eigen::Index q) const {
    const auto g = [&](Eigen::Index c, Eigen::Index d) { return gradient_(q, 3 * c + d); };
    Voigt e;
    e << g(0, 0), g(1, 1), g(2, 2), g(0, 1) + g(1, 0), g(1, 2) + g(2, 1), g(2, 0) + g(0, 2);
    return e;
  }
  Voigt stress(const Voigt& strain) const { return material_.C * strain; }

 private:
  const SolutionSpace& space_;
  const ElasticMaterial& material_;
  const Eigen::VectorXd& u_;
  SpanShapes shapes_;
  Eigen::MatrixXd coefficients_, displacement_, gradient_, along_;
};

} // namespace

PointFields recover_fields(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                           std::span<const std::int64_t> offsets, std::span<const double> parameters) {
  const std::size_t n = parameters.size() / 3;
  PointFields fields;
  fields.displacement.resize(3 * n);
  fields.strain.resize(6 * n);
  fields.stress.resize(6 * n);
  fields.von_mises.resize(n);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, space.num_spans(), 16), [&](const auto& range) {
    SpanRecovery recovery(space, material, u);
    for (std::int64_t a = range.begin(); a != range.end(); ++a) {
      const auto first = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a)]);
      const auto count = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a) + 1]) - first;
      if (count == 0) continue;
      recovery.at(a, parameters.subspan(3 * first, 3 * count));
      for (std::size_t q = 0; q < count; ++q) {
        const auto row = static_cast<Eigen::Index>(q);
        const Eigen::Vector3d displacement = recovery.displacement(row);
        const Voigt strain = recovery.strain(row), stress = recovery.stress(strain);
        std::copy_n(displacement.data(), 3, fields.displacement.data() + 3 * (first + q));
        std::copy_n(strain.data(), 6, fields.strain.data() + 6 * (first + q));
        std::copy_n(stress.data(), 6, fields.stress.data() + 6 * (first + q));
        fields.von_mises[first + q] = von_mises(stress);
      }
    }
  });
  return fields;
}

double strain_energy(const TrimmedModel& model, const PointFields& fields) {
  double energy = 0;
  for (std::size_t q = 0; q < fields.size(); ++q) {
    double density = 0;
    for (std::size_t k = 0; k < 6; ++k) density += fields.stress[6 * q + k] * fields.strain[6 * q + k];
    energy += 0.5 * model.points.weights[q] * density;
  }
  return energy;
}

std::vector<ProbeResult> locate_probes(const TrimmedModel& model, std::span<const Probe> probes) {
  std::vector<ProbeResult> results;
  for (const Probe& probe : probes) {
    ProbeResult result;
    result.name = probe.name;
    result.at = locate(model, probe.position, fmt::format("probe '{}'", probe.name));
    results.push_back(std::move(result));
  }
  return results;
}

void recover_probes(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                    std::vector<ProbeResult>& probes) {
  SpanRecovery recovery(space, material, u);
  for (ProbeResult& probe : probes) {
    recovery.at(probe.at.span, probe.at.parameter);
    const Eigen::Vector3d displacement = recovery.displacement(0);
    probe.displacement = {displacement[0], displacement[1], displacement[2]};
    probe.strain = recovery.strain(0);
    probe.stress = recovery.stress(probe.strain);
    probe.von_mises = von_mises(probe.stress);
  }
}

} // namespace iga::solve
