#include "solver/output/recover.hpp"

#include "solver/output/sample_fields.hpp"

#include <fmt/format.h>

namespace iga::solve {

FieldSamples recover_fields(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                            std::span<const std::int64_t> offsets, const std::vector<double>& parameters) {
  SamplePoints points;
  points.parameters = parameters;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto first = static_cast<std::size_t>(a);
    points.cell.insert(points.cell.end(), static_cast<std::size_t>(offsets[first + 1] - offsets[first]), a);
  }
  return sample_fields(space, material, points, u, Fields::All);
}

double strain_energy(const TrimmedModel& model, const FieldSamples& fields) {
  double energy = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    double density = 0;
    for (std::size_t k = 0; k < 6; ++k) density += fields.stress[6 * q + k] * fields.strain[6 * q + k];
    energy += 0.5 * model.points.weights[q] * density;
  }
  return energy;
}

double initial_strain_work(const TrimmedModel& model, const ElasticMaterial& material, const FieldSamples& fields) {
  if (!material.initial_strain) return 0;
  double work = 0;
  std::size_t q = 0;
  for (std::int64_t a = 0; a < static_cast<std::int64_t>(model.num_cells()); ++a) {
    const Strains initial = material.initial_strain->at(a, cell_parameters(model, a));
    for (Eigen::Index i = 0; i < initial.rows(); ++i, ++q)
      work -= 0.5 * model.points.weights[q] *
              initial.row(i).dot(Eigen::Map<const Eigen::RowVectorXd>(&fields.stress[6 * q], 6));
  }
  return work;
}

std::vector<LocatedPoint> locate_probes(const TrimmedModel& model, std::span<const Probe> probes) {
  std::vector<LocatedPoint> located;
  if (probes.empty()) return located;
  const Locator locator(model);
  for (const Probe& probe : probes)
    located.push_back(locator.locate(probe.position, fmt::format("probe '{}'", probe.name)));
  return located;
}

ProbeResult recover_probes(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                           std::span<const Probe> probes, std::span<const LocatedPoint> located) {
  ProbeResult result;
  SamplePoints points;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    result.names.push_back(probes[k].name);
    result.positions.insert(result.positions.end(), located[k].position.begin(), located[k].position.end());
    points.cell.push_back(located[k].cell);
    points.parameters.insert(points.parameters.end(), located[k].parameter.begin(), located[k].parameter.end());
  }
  result.fields = sample_fields(space, material, points, u, Fields::All);
  return result;
}

} // namespace iga::solve
