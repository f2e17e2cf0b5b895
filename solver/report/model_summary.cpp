#include "solver/report/model_summary.hpp"

#include <algorithm>

namespace iga::solve {

ModelSummary summarise(const TrimmedModel& model) {
  ModelSummary s;
  s.points = static_cast<std::int64_t>(model.points.weights.size());
  Point3 first{}; // about the grid's first corner, where no digits are lost
  for (std::size_t a = 0; a < model.cells.span.size(); ++a) {
    const std::int64_t count = model.points.offsets[a + 1] - model.points.offsets[a];
    if (model.is_interior(a)) {
      ++s.interior;
      s.interior_points += count;
    } else {
      s.trimmed += a == 0 || model.cells.span[a] != model.cells.span[a - 1];
    }
  }
  s.cells = count_cells(model);
  s.exterior = model.grid.num_spans() - s.interior - s.trimmed;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    s.volume += model.points.weights[q];
    for (std::size_t d = 0; d < 3; ++d)
      first[d] += model.points.weights[q] * (model.points.parameters[3 * q + d] - model.grid.A()[d]);
  }
  Point3 centre{};
  for (std::size_t d = 0; d < 3; ++d) centre[d] = model.grid.A()[d] + first[d] / s.volume;
  s.centroid = model.grid.to_position(centre);
  for (const double chi : model.unknown_mass_fraction()) {
    s.light_functions += chi < light_below;
    s.lightest = std::min(s.lightest, chi);
  }
  for (const std::string& name : model.surface.mesh.region_names) s.regions.push_back({name, 0, 0});
  for (const std::int32_t r : model.surface.mesh.region) ++s.regions[static_cast<std::size_t>(r)].triangles;
  const auto& q = model.surface.quadrature;
  s.surface_points = static_cast<std::int64_t>(q.weights.size());
  for (std::size_t i = 0; i < q.weights.size(); ++i) {
    const auto t = static_cast<std::size_t>(q.triangle[i]);
    s.regions[static_cast<std::size_t>(model.surface.mesh.region[t])].area += q.weights[i];
    s.area += q.weights[i];
  }
  return s;
}

} // namespace iga::solve
