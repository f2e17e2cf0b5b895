#include "solver/explicit/run_overlap.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/closest_point.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

constexpr std::size_t most_points = 2000; // per side: overlaps that matter hold many vertices
constexpr double deepest = 0.5;           // of a span

struct Depth {
  double depth = 0;
  Point3 place{};
};

// Winding number by solid angles (van Oosterom and Strackee 1983): 1 inside, 0 outside.
double winding(const TriangleMesh& mesh, const Point3& x) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    std::array<Point3, 3> r;
    std::array<double, 3> length;
    for (std::size_t c = 0; c < 3; ++c) {
      r[c] = minus(mesh.vertices[static_cast<std::size_t>(t[c])], x);
      length[c] = norm(r[c]);
    }
    const double top = dot(r[0], cross(r[1], r[2]));
    const double bottom = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] +
                          dot(r[1], r[2]) * length[0] + dot(r[2], r[0]) * length[1];
    sum += 2 * std::atan2(top, bottom);
  }
  return sum / (4 * std::numbers::pi);
}

double distance(const TriangleMesh& mesh, const Point3& x) {
  double least = std::numeric_limits<double>::infinity();
  const auto at = [&mesh](std::int32_t v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  for (const Triangle& t : mesh.triangles)
    least = std::min(least, closest_on_triangle(x, at(t[0]), at(t[1]), at(t[2])).distance2);
  return std::sqrt(least);
}

// Depth of the deepest point inside the mesh.
Depth deepest_inside(const TriangleMesh& mesh, const std::vector<Point3>& points) {
  const Box3 box = bounding_box(mesh);
  std::vector<Point3> near;
  for (const Point3& x : points) {
    bool inside = true;
    for (std::size_t d = 0; d < 3; ++d) inside = inside && x[d] > box.lower[d] && x[d] < box.upper[d];
    if (inside) near.push_back(x);
  }
  const std::size_t stride = near.size() / most_points + 1;
  std::vector<double> depth((near.size() + stride - 1) / stride, 0);
  tbb::parallel_for(std::size_t{0}, depth.size(), [&](std::size_t k) {
    const Point3& x = near[k * stride];
    if (winding(mesh, x) > 0.5) depth[k] = distance(mesh, x);
  });
  Depth found;
  for (std::size_t k = 0; k < depth.size(); ++k)
    if (depth[k] > found.depth) found = {depth[k], near[k * stride]};
  return found;
}

Depth deepest_in_shape(const RigidState& rigid, const std::vector<Point3>& points) {
  Depth found;
  for (const Point3& x : points) {
    const double gap = distance_to_shape(rigid.body().shape, rigid.to_body(x)).gap;
    if (-gap > found.depth) found = {-gap, x};
  }
  return found;
}

Depth deeper(const Depth& a, const Depth& b) {
  return b.depth > a.depth ? b : a;
}

// Rigid bodies where they stand at the start.
Depth with_rigid(const TriangleMesh& mesh, const RigidState& rigid) {
  if (const auto* tool = std::get_if<MeshShape>(&rigid.body().shape)) {
    TriangleMesh placed = tool->mesh;
    for (Point3& x : placed.vertices) x = rigid.to_space(x);
    return deeper(deepest_inside(placed, mesh.vertices), deepest_inside(mesh, placed.vertices));
  }
  const Depth found = deepest_in_shape(rigid, mesh.vertices);
  // A small shape inside a large body holds none of its vertices.
  return std::holds_alternative<PlaneShape>(rigid.body().shape)
             ? found
             : deeper(found, deepest_inside(mesh, {rigid.to_space({})}));
}

} // namespace

void refuse_deep_overlap(const ExplicitRun& run, const std::vector<ContactSurface>& surfaces) {
  for (const ContactRun& contact : run.contacts) {
    const ContactSide &first = contact.pair.first, &second = contact.pair.second;
    const ContactSurface& surface = surfaces[first.number];
    Depth found;
    double span = surface.span_size;
    if (second.kind == ContactSide::Kind::Rigid) {
      found = with_rigid(surface.mesh, RigidState(run.rigid[second.number].body));
    } else if (second.number != first.number) {
      const ContactSurface& other = surfaces[second.number];
      span = std::min(span, other.span_size);
      found =
          deeper(deepest_inside(other.mesh, surface.mesh.vertices), deepest_inside(surface.mesh, other.mesh.vertices));
    }
    if (found.depth > deepest * span)
      throw InputError(fmt::format(
          "{}: contact '{}': the bodies overlap by {:.4g} at the start near ({:.6g}, {:.6g}, {:.6g}), "
          "more than half a span ({:.4g}); move them apart",
          contact.where, contact.pair.name, found.depth, found.place[0], found.place[1], found.place[2], span));
  }
}

} // namespace iga::solve
