#include "samples/solids.hpp"

#include "samples/surface_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace iga::samples {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
constexpr double pi = std::numbers::pi;

TriangleMesh with_one_region(TriangleMesh mesh) {
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"surface"};
  return mesh;
}

} // namespace

TriangleMesh box(const Point3& lower, const Point3& upper) {
  return extrude({{lower[0], lower[1]}, {upper[0], lower[1]}, {upper[0], upper[1]}, {lower[0], upper[1]}}, lower[2],
                 upper[2]);
}

TriangleMesh icosphere(const Point3& centre, double radius, int refinement) {
  const double g = std::numbers::phi;
  std::vector<Point3> v{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> t{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  const auto normalise = [](Point3& x) {
    const double length = std::hypot(x[0], x[1], x[2]);
    for (double& c : x) c /= length;
  };
  for (Point3& x : v) normalise(x);
  for (int level = 0; level < refinement; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
    const auto middle_of = [&](std::int32_t a, std::int32_t b) {
      const auto [entry, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(v.size()));
      if (is_new) {
        const Point3 p = v[static_cast<std::size_t>(a)], q = v[static_cast<std::size_t>(b)];
        v.push_back({p[0] + q[0], p[1] + q[1], p[2] + q[2]});
        normalise(v.back());
      }
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : t) {
      const std::int32_t ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    t = std::move(finer);
  }
  for (Point3& x : v)
    for (std::size_t d = 0; d < 3; ++d) x[d] = centre[d] + radius * x[d];
  return with_one_region({.vertices = std::move(v), .triangles = std::move(t), .region = {}, .region_names = {}});
}

TriangleMesh torus(const Point3& centre, double ring_radius, double tube_radius, int around, int section) {
  TriangleMesh mesh;
  const auto number = [&](int i, int j) { return (i % around) * section + j % section; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < section; ++j) {
      const double a = 2 * pi * i / around, b = 2 * pi * j / section;
      const double r = ring_radius + tube_radius * std::cos(b);
      mesh.vertices.push_back(
          {centre[0] + r * std::cos(a), centre[1] + r * std::sin(a), centre[2] + tube_radius * std::sin(b)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  return with_one_region(std::move(mesh));
}

TriangleMesh revolved(const std::vector<Point2>& profile, int around) {
  TriangleMesh mesh;
  const int rings = static_cast<int>(profile.size()) - 2;
  const auto number = [&](int ring, int i) { return 1 + ring * around + i % around; };
  mesh.vertices.push_back({0, 0, profile.front()[1]});
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const auto& [r, z] = profile[static_cast<std::size_t>(ring) + 1];
      const double a = 2 * pi * i / around;
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), z});
    }
  mesh.vertices.push_back({0, 0, profile.back()[1]});
  const int top = 1 + rings * around;
  for (int i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, number(0, i + 1), number(0, i)});
    mesh.triangles.push_back({top, number(rings - 1, i), number(rings - 1, i + 1)});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      mesh.triangles.push_back({number(ring, i), number(ring, i + 1), number(ring + 1, i + 1)});
      mesh.triangles.push_back({number(ring, i), number(ring + 1, i + 1), number(ring + 1, i)});
    }
  }
  return with_one_region(std::move(mesh));
}

TriangleMesh extrude(const std::vector<Point2>& profile, double z_low, double z_high) {
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> bottom, top;
  for (const auto& [x, y] : profile) {
    bottom.push_back(mesh.add_vertex(Kernel::Point_3(x, y, z_low)));
    top.push_back(mesh.add_vertex(Kernel::Point_3(x, y, z_high)));
  }
  const std::size_t n = profile.size();
  for (std::size_t i = 0; i < n; ++i) mesh.add_face(bottom[i], bottom[(i + 1) % n], top[(i + 1) % n], top[i]);
  mesh.add_face(top);
  mesh.add_face(std::vector(bottom.rbegin(), bottom.rend()));
  if (!pmp::triangulate_faces(mesh)) throw std::runtime_error("extrude: the profile is no simple polygon");
  return to_triangles(mesh);
}

TriangleMesh cylinder(const Point2& centre, double radius, double z_low, double z_high, int segments) {
  std::vector<Point2> profile;
  for (int i = 0; i < segments; ++i) {
    const double a = 2 * pi * i / segments;
    profile.push_back({centre[0] + radius * std::cos(a), centre[1] + radius * std::sin(a)});
  }
  return extrude(profile, z_low, z_high);
}

std::vector<Point2> rounded(const std::vector<Point2>& corners, const std::vector<double>& radius, int segments) {
  std::vector<Point2> profile;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 c = corners[i], before = corners[(i + n - 1) % n], after = corners[(i + 1) % n];
    if (radius.at(i) == 0) {
      profile.push_back(c);
      continue;
    }
    const double la = std::hypot(before[0] - c[0], before[1] - c[1]), lb = std::hypot(after[0] - c[0], after[1] - c[1]);
    const Point2 a{(before[0] - c[0]) / la, (before[1] - c[1]) / la}, b{(after[0] - c[0]) / lb, (after[1] - c[1]) / lb};
    const double half = std::acos(a[0] * b[0] + a[1] * b[1]) / 2; // half the angle at the corner
    const double to_tangent = radius[i] / std::tan(half), to_centre = radius[i] / std::sin(half);
    const double lm = std::hypot(a[0] + b[0], a[1] + b[1]);
    const Point2 m{c[0] + to_centre * (a[0] + b[0]) / lm, c[1] + to_centre * (a[1] + b[1]) / lm};
    const Point2 first{c[0] + to_tangent * a[0] - m[0], c[1] + to_tangent * a[1] - m[1]};
    const double side = a[0] * b[1] - a[1] * b[0] < 0 ? 1 : -1; // convex corners turn anticlockwise
    for (int s = 0; s <= segments; ++s) {
      const double turn = side * (pi - 2 * half) * s / segments;
      profile.push_back({m[0] + first[0] * std::cos(turn) - first[1] * std::sin(turn),
                         m[1] + first[0] * std::sin(turn) + first[1] * std::cos(turn)});
    }
  }
  return profile;
}

TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto shift = static_cast<std::int32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + shift, j + shift, k + shift});
  return with_one_region(std::move(a));
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const std::array<Point3, 3>& axes, const Point3& shift) {
  for (Point3& x : mesh.vertices) {
    const Point3 old = x;
    for (std::size_t d = 0; d < 3; ++d)
      x[d] = axes[d][0] * old[0] + axes[d][1] * old[1] + axes[d][2] * old[2] + shift[d];
  }
  return mesh;
}

TriangleMesh united(const TriangleMesh& a, const TriangleMesh& b) {
  SurfaceMesh left = to_surface_mesh(a), right = to_surface_mesh(b), result;
  if (!pmp::corefine_and_compute_union(left, right, result))
    throw std::runtime_error("the union of two solids is no closed manifold");
  return to_triangles(result);
}

TriangleMesh subtracted(const TriangleMesh& a, const TriangleMesh& b) {
  SurfaceMesh left = to_surface_mesh(a), right = to_surface_mesh(b), result;
  if (!pmp::corefine_and_compute_difference(left, right, result))
    throw std::runtime_error("the difference of two solids is no closed manifold");
  return to_triangles(result);
}

} // namespace iga::samples
