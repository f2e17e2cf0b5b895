// Distances to the shapes with a closed form.
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

ShapeDistance distance(const PlaneShape& plane, const Point3& x) {
  return {dot(x, plane.normal), plane.normal};
}

ShapeDistance distance(const SphereShape& sphere, const Point3& x) {
  const double r = norm(x);
  return {r - sphere.radius, r > 0 ? times(x, 1 / r) : Point3{0, 0, 1}};
}

// In the half plane (r, z): a rectangle with one corner.
ShapeDistance distance(const CylinderShape& c, const Point3& x) {
  const double z = dot(x, c.axis), height = z < 0 ? -1 : 1;
  const Point3 across = minus(x, times(c.axis, z));
  const double r = norm(across);
  Point3 radial = r > 0 ? times(across, 1 / r) : Point3{};
  if (r == 0) { // on the axis any direction is as near
    const std::size_t d = std::abs(c.axis[0]) < 0.6 ? 0 : 1;
    Point3 e{};
    e[d] = 1;
    radial = cross(c.axis, e);
    radial = times(radial, 1 / norm(radial));
  }
  const double beyond_r = r - c.radius, beyond_z = std::abs(z) - c.half_length;
  if (beyond_r > 0 && beyond_z > 0) {
    const double gap = std::hypot(beyond_r, beyond_z);
    return {gap, plus(times(radial, beyond_r / gap), times(c.axis, height * beyond_z / gap))};
  }
  if (beyond_r >= beyond_z) return {beyond_r, radial};
  return {beyond_z, times(c.axis, height)};
}

ShapeDistance distance(const MeshShape&, const Point3&) {
  return {std::numeric_limits<double>::infinity(), {}};
}

} // namespace

ShapeDistance distance_to_shape(const RigidShape& shape, const Point3& x) {
  return std::visit([&](const auto& s) { return distance(s, x); }, shape);
}

double bounding_radius(const RigidShape& shape) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return sphere->radius;
  if (const auto* c = std::get_if<CylinderShape>(&shape)) return std::hypot(c->radius, c->half_length);
  if (const auto* m = std::get_if<MeshShape>(&shape)) {
    double r = 0;
    for (const Point3& x : m->mesh.vertices) r = std::max(r, norm(x));
    return r;
  }
  return std::numeric_limits<double>::infinity();
}

MeshShape box_shape(const Point3& half) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    Point3 x{};
    for (std::size_t d = 0; d < 3; ++d) x[d] = (corner >> d) & 1 ? half[d] : -half[d];
    mesh.vertices.push_back(x);
  }
  for (int d = 0; d < 3; ++d)
    for (int high = 0; high < 2; ++high) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      const auto corner = [&](int on_e, int on_f) { return (high << d) | (on_e << e) | (on_f << f); };
      Triangle low{corner(0, 0), corner(1, 0), corner(1, 1)}, up{corner(0, 0), corner(1, 1), corner(0, 1)};
      if (high == 0) {
        std::swap(low[1], low[2]);
        std::swap(up[1], up[2]);
      }
      mesh.triangles.push_back(low);
      mesh.triangles.push_back(up);
    }
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"box"};
  return {mesh};
}

} // namespace iga::solve
