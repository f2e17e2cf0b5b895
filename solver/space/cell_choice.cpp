#include "solver/space/cell_choice.hpp"

#include "solver/space/convex_clip.hpp"

#include <limits>

namespace iga::solve {

namespace {

// Distance of u from the part of a triangle inside a box, everything in parameters; infinite where there is none.
double distance_within(const TrimmedModel& model, std::int32_t triangle, const Box3& box, const Point3& u) {
  ConvexPolygon polygon;
  for (const std::int32_t v : model.surface.mesh.triangles[static_cast<std::size_t>(triangle)])
    polygon.push_back(model.grid.to_parameter(model.surface.mesh.vertices[static_cast<std::size_t>(v)]));
  for (std::size_t d = 0; d < 3 && polygon.size() >= 3; ++d) {
    polygon = clip_convex(polygon, [&](const Point3& x) { return box.lower[d] - x[d]; });
    polygon = clip_convex(polygon, [&](const Point3& x) { return x[d] - box.upper[d]; });
  }
  return distance_to_polygon(polygon, u);
}

} // namespace

std::size_t choose_cell(const TrimmedModel& model, std::int64_t span, const Point3& u) {
  const auto [first, last] = model.cells_of(span);
  if (last - first < 2) return first;
  const Box3 box = model.grid.span_box(model.grid.span_index(span));
  const auto& surface = model.surface.quadrature;
  std::size_t best = first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t c = first; c < last; ++c) {
    std::int32_t before = -1;
    for (auto q = surface.offsets[c]; q < surface.offsets[c + 1]; ++q) {
      const std::int32_t triangle = surface.triangle[static_cast<std::size_t>(q)];
      if (triangle == before) continue;
      before = triangle;
      const double distance = distance_within(model, triangle, box, u);
      if (distance >= nearest) continue;
      nearest = distance;
      best = c;
    }
  }
  return best;
}

} // namespace iga::solve
