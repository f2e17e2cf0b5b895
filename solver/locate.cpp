#include "solver/locate.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <numbers>

namespace iga::solve {

namespace {

double distance_to_surface(const TriangleMesh& mesh, const Point3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) least = std::min(least, distance_to_triangle(mesh, t, x));
  return least;
}

// Squared distance in spans from a parameter to a closed span, and the nearest parameter in it.
std::pair<double, Point3> nearest_in_span(const SplineGrid& grid, std::int64_t number, const Point3& u) {
  const Box3 box = grid.span_box(grid.span_index(number));
  const Point3 h = grid.span_size();
  Point3 nearest{};
  double squared = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    nearest[d] = std::clamp(u[d], box.lower[d], box.upper[d]);
    squared += std::pow((u[d] - nearest[d]) / h[d], 2);
  }
  return {squared, nearest};
}

} // namespace

double winding_number(const TriangleMesh& mesh, const Point3& x) {
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto to = [&](std::size_t k) { return minus(mesh.vertices[static_cast<std::size_t>(t[k])], x); };
    const Point3 a = to(0), b = to(1), c = to(2);
    const double la = norm(a), lb = norm(b), lc = norm(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

LocatedPoint locate(const TrimmedModel& model, const Point3& x, const std::string& what) {
  const Point3 h = model.grid.span_size();
  const double allowance = outside_allowance * *std::min_element(h.begin(), h.end());
  if (winding_number(model.surface.mesh, x) < 0.5) {
    const double distance = distance_to_surface(model.surface.mesh, x);
    if (distance > allowance) {
      const Box3 box = bounding_box(model.surface.mesh);
      throw InputError(fmt::format(
          "{}: the position ({:.6g}) lies outside the part, {:.4g} from its surface; the part lies between ({:.6g}) "
          "and ({:.6g}): choose a position in it or on its surface",
          what, fmt::join(x, ", "), distance, fmt::join(box.lower, ", "), fmt::join(box.upper, ", ")));
    }
  }
  // On a face between spans the fuller one wins, then the lower number.
  constexpr double same_place = 1e-20;
  const Point3 u = model.grid.to_parameter(x);
  LocatedPoint best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.active.size(); ++a) {
    const auto [squared, parameter] = nearest_in_span(model.grid, model.active[a], u);
    const bool fuller = squared <= least + same_place &&
                        model.volume_fraction[a] > model.volume_fraction[static_cast<std::size_t>(best.span)];
    if (squared < least - same_place || fuller || a == 0) {
      least = squared;
      best = {static_cast<std::int64_t>(a), parameter, x, {}};
    }
  }
  best.position = model.grid.to_position(best.parameter);
  return best;
}

} // namespace iga::solve
