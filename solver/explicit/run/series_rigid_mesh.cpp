#include "solver/explicit/run/series_rigid_mesh.hpp"

#include "format/model/vec3.hpp"

#include <cmath>
#include <numbers>

namespace iga::solve {

namespace {

constexpr int around = 48; // facets about an axis

// Two unit vectors that make a right-handed frame with n.
std::array<Point3, 2> frame_of(const Point3& n) {
  const Point3 other = std::abs(n[0]) < 0.7 ? Point3{1, 0, 0} : Point3{0, 1, 0};
  const Point3 a = cross(n, other), unit = times(a, 1 / norm(a));
  return {unit, cross(n, unit)};
}

Point3 on_circle(const std::array<Point3, 2>& frame, int k) {
  const double angle = 2 * std::numbers::pi * k / around;
  return plus(times(frame[0], std::cos(angle)), times(frame[1], std::sin(angle)));
}

// Rings of points from a lower pole to an upper one, both on the axis.
TriangleMesh of_rings(const Point3& lower, const std::vector<std::vector<Point3>>& rings, const Point3& upper) {
  TriangleMesh mesh;
  mesh.vertices.push_back(lower);
  for (const auto& ring : rings) mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  mesh.vertices.push_back(upper);
  const auto top = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
  const auto at = [](std::size_t ring, int k) {
    return static_cast<std::int32_t>(1 + static_cast<int>(ring) * around + k % around);
  };
  for (int k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
      mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
    mesh.triangles.push_back({at(rings.size() - 1, k), at(rings.size() - 1, k + 1), top});
  }
  return mesh;
}

TriangleMesh sphere(double radius) {
  const auto frame = frame_of({0, 0, 1});
  std::vector<std::vector<Point3>> rings;
  for (int r = 1; r < around / 2; ++r) {
    const double angle = 2 * std::numbers::pi * r / around - std::numbers::pi / 2;
    rings.emplace_back();
    for (int k = 0; k < around; ++k)
      rings.back().push_back(
          plus(times(on_circle(frame, k), radius * std::cos(angle)), {0, 0, radius * std::sin(angle)}));
  }
  return of_rings({0, 0, -radius}, rings, {0, 0, radius});
}

TriangleMesh cylinder(const CylinderShape& shape) {
  const auto frame = frame_of(shape.axis);
  std::vector<std::vector<Point3>> rings(2);
  for (int k = 0; k < around; ++k)
    for (const int side : {0, 1})
      rings[static_cast<std::size_t>(side)].push_back(
          plus(times(on_circle(frame, k), shape.radius), times(shape.axis, (2 * side - 1) * shape.half_length)));
  return of_rings(times(shape.axis, -shape.half_length), rings, times(shape.axis, shape.half_length));
}

TriangleMesh plane(const PlaneShape& shape, double size) {
  const auto [a, b] = frame_of(shape.normal);
  TriangleMesh mesh;
  for (const auto& [s, t] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
    mesh.vertices.push_back(plus(times(a, 0.5 * size * s), times(b, 0.5 * size * t)));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

} // namespace

TriangleMesh shape_mesh(const RigidShape& shape, double plane_size) {
  TriangleMesh mesh;
  if (const auto* s = std::get_if<SphereShape>(&shape)) mesh = sphere(s->radius);
  if (const auto* p = std::get_if<PlaneShape>(&shape)) mesh = plane(*p, plane_size);
  if (const auto* c = std::get_if<CylinderShape>(&shape)) mesh = cylinder(*c);
  if (const auto* m = std::get_if<MeshShape>(&shape)) return m->mesh;
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"surface"};
  return mesh;
}

} // namespace iga::solve
