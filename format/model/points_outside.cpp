#include "format/model/points_outside.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga {

PointsOutside find_points_outside(const TrimmedModel& model) {
  return find_points_outside(model, TriangleTree(model.surface.mesh));
}

PointsOutside find_points_outside(const TrimmedModel& model, const TriangleTree& tree) {
  const double allowed = surface_depth(model);
  const auto& parameters = model.points.parameters;
  PointsOutside out;
  double total = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    total += model.points.weights[q];
    const Point3 x = model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
    const std::optional<int> winding = tree.winding_number(x);
    if (!winding || *winding > 0) continue; // inside, or on the surface
    const double away = tree.distance(x);
    if (away <= allowed) continue;
    ++out.count;
    out.weight += model.points.weights[q];
    if (away <= out.deepest) continue;
    out.deepest = away;
    out.where = x;
    out.point = static_cast<std::int64_t>(q);
  }
  out.weight /= total;
  return out;
}

std::string describe(const PointsOutside& outside, const TrimmedModel& model) {
  if (outside.count == 0) return {};
  const Point3 h = model.grid.span_size();
  return fmt::format(
      "quadrature/parameters: {} of {} points {} outside the surface, {:.3g} of the volume by weight; the "
      "deepest is point {} near ({:.6g}, {:.6g}, {:.6g}), {:.3g} outside ({:.3g} spans), expected every "
      "point inside the solid",
      outside.count, model.points.weights.size(), outside.count == 1 ? "lies" : "lie", outside.weight, outside.point,
      outside.where[0], outside.where[1], outside.where[2], outside.deepest,
      outside.deepest / std::max({h[0], h[1], h[2]}));
}

} // namespace iga
