#include "solver/space/locate.hpp"

#include "format/model/errors.hpp"
#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/convex_clip.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <numbers>

namespace iga::solve {

namespace {

// Distances (in spans) of no more than this are rounding.
constexpr double rounding = 1e-9;
// The other wall of a gap lies across it: seen from a place between them within 60° of the way straight on.
constexpr double straight_on = 0.5;

/// Where the surface comes nearest to a place.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t triangle = 0;
  Point3 way{}; ///< from the place to there

  void offer(std::size_t t, const Point3& to) {
    const double length = norm(to);
    if (length >= distance) return;
    distance = length;
    triangle = t;
    way = to;
  }
};

// The part of a triangle inside a box, everything in parameters.
ConvexPolygon part_in_box(const TrimmedModel& model, std::size_t triangle, const Box3& box) {
  ConvexPolygon polygon;
  for (const std::int32_t v : model.surface.mesh.triangles[triangle])
    polygon.push_back(model.grid.to_parameter(model.surface.mesh.vertices[static_cast<std::size_t>(v)]));
  for (std::size_t d = 0; d < 3; ++d) { // most triangles lie beside it
    const auto [low, high] = std::minmax({polygon[0][d], polygon[1][d], polygon[2][d]});
    if (high < box.lower[d] || low > box.upper[d]) return {};
  }
  for (std::size_t d = 0; d < 3 && polygon.size() >= 3; ++d) {
    polygon = clip_convex(polygon, [&](const Point3& x) { return box.lower[d] - x[d]; });
    polygon = clip_convex(polygon, [&](const Point3& x) { return x[d] - box.upper[d]; });
  }
  return polygon;
}

Nearest nearest_in_box(const TrimmedModel& model, const Box3& box, const Point3& u) {
  Nearest nearest;
  for (std::size_t t = 0; t < model.surface.mesh.triangles.size(); ++t) {
    const ConvexPolygon part = part_in_box(model, t, box);
    for (std::size_t a = 1; a + 1 < part.size(); ++a)
      nearest.offer(t, way_to_triangle({part[0], part[a], part[a + 1]}, u));
  }
  return nearest;
}

double smallest(const Point3& h) {
  return *std::min_element(h.begin(), h.end());
}

// What is far below the size of the part is rounding: 0.
std::string text(Point3 x, const Box3& part) {
  const double smallest_said = 1e-12 * norm(minus(part.upper, part.lower));
  for (double& c : x)
    if (std::abs(c) < smallest_said) c = 0;
  return fmt::format("({:.6g})", fmt::join(x, ", "));
}

} // namespace

double winding_number(const TriangleMesh& mesh, const Point3& x) {
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    angle += solid_angle({corner(0), corner(1), corner(2)}, x);
  }
  return angle / (4 * std::numbers::pi);
}

std::int64_t Locator::cell_in_solid(const Point3& u) const {
  const SplineGrid& grid = model_.grid;
  Index3 low{}, high{}; // spans whose closed box holds the place
  for (std::size_t d = 0; d < 3; ++d) {
    const double xi = (u[d] - grid.A()[d]) / grid.span_size()[d];
    const auto span_at = [&](double at) {
      return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at)), 0, grid.spans()[d] - 1);
    };
    low[d] = span_at(xi - rounding);
    high[d] = span_at(xi + rounding);
  }
  // The first that holds material; where all are slivers that were left out, the first.
  const auto state = [&](std::int64_t s) { return static_cast<SpanState>(model_.state[static_cast<std::size_t>(s)]); };
  std::int64_t span = grid.span_number(low);
  for (std::int64_t k = low[2]; k <= high[2]; ++k)
    for (std::int64_t j = low[1]; j <= high[1]; ++j)
      for (std::int64_t i = low[0]; i <= high[0]; ++i)
        if (const std::int64_t other = grid.span_number({i, j, k});
            state(span) == SpanState::Exterior && state(other) != SpanState::Exterior)
          span = other;
  const auto [first, last] = model_.cells_of(span);
  if (state(span) == SpanState::Interior) return static_cast<std::int64_t>(first);
  const Nearest nearest = nearest_in_box(model_, grid.span_box(grid.span_index(span)), u);
  if (std::isfinite(nearest.distance)) return surface_.find(nearest.triangle, plus(u, nearest.way)).cell;
  if (first < last) return static_cast<std::int64_t>(first);
  Nearest anywhere;
  for (std::size_t t = 0; t < model_.surface.mesh.triangles.size(); ++t)
    anywhere.offer(t, way_to_triangle(model_.surface.mesh, t, grid.to_position(u)));
  return surface_.find(anywhere.triangle, grid.to_parameter(plus(grid.to_position(u), anywhere.way))).cell;
}

// Of a place outside the surface.
std::int64_t Locator::cell_outside(const Point3& x, const std::string& what) const {
  const TriangleMesh& mesh = model_.surface.mesh;
  const double h = smallest(model_.grid.span_size());
  Nearest nearest;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) nearest.offer(t, way_to_triangle(mesh, t, x));
  if (nearest.distance > outside_allowance * h) {
    const Box3 box = bounding_box(mesh);
    throw InputError(fmt::format(
        "{}: the position {} lies outside the part, {:.4g} from its surface; the part lies between {} and {}: choose a "
        "position in it or on its surface",
        what, text(x, box), nearest.distance, text(box.lower, box), text(box.upper, box)));
  }
  const auto owner = [&] {
    return surface_.find(nearest.triangle, model_.grid.to_parameter(plus(x, nearest.way))).cell;
  };
  if (nearest.distance <= rounding * h) return owner();
  Nearest opposite;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Point3 way = way_to_triangle(mesh, t, x);
    if (-dot(way, nearest.way) >= straight_on * norm(way) * nearest.distance) opposite.offer(t, way);
  }
  const double width = nearest.distance + opposite.distance;
  if (nearest.distance > gap_allowance * width) {
    const Box3 box = bounding_box(mesh);
    throw InputError(fmt::format("{}: the position {} lies in a gap of {:.4g} between two walls, {:.4g} from one at {} "
                                 "and {:.4g} from the other "
                                 "at {}: choose a position in one of them or on its surface",
                                 what, text(x, box), width, nearest.distance, text(plus(x, nearest.way), box),
                                 opposite.distance, text(plus(x, opposite.way), box)));
  }
  return owner();
}

LocatedPoint Locator::locate(const Point3& x, const std::string& what) const {
  Point3 u = model_.grid.to_parameter(x);
  const bool outside = winding_number(model_.surface.mesh, x) < 0.5;
  const std::int64_t cell = outside ? cell_outside(x, what) : cell_in_solid(u);
  const Box3 box = model_.grid.span_box(model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(cell)]));
  for (std::size_t d = 0; d < 3; ++d) u[d] = std::clamp(u[d], box.lower[d], box.upper[d]);
  return {cell, u, x, model_.grid.to_position(u)};
}

LocatedPoint locate(const TrimmedModel& model, const Point3& x, const std::string& what) {
  return Locator(model).locate(x, what);
}

} // namespace iga::solve
