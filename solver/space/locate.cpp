#include "solver/space/locate.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/nearest_span.hpp"

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

} // namespace

double winding_number(const TriangleMesh& mesh, const Point3& x) {
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    angle += solid_angle({corner(0), corner(1), corner(2)}, x);
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
  const NearestSpan nearest = nearest_span(model, model.grid.to_parameter(x), {});
  return {nearest.cell, nearest.parameter, x, model.grid.to_position(nearest.parameter)};
}

} // namespace iga::solve
