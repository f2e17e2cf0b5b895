#include "format/model/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga {

namespace {

Point3 minus(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
const Point3& corner(const TriangleMesh& mesh, const Triangle& t, std::size_t i) {
  return mesh.vertices[static_cast<std::size_t>(t[i])];
}

} // namespace

Box3 bounding_box(const TriangleMesh& mesh) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box3 box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Triangle& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t d = 0; d < 3; ++d) {
        box.lower[d] = std::min(box.lower[d], corner(mesh, t, i)[d]);
        box.upper[d] = std::max(box.upper[d], corner(mesh, t, i)[d]);
      }
  return box;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 n =
        cross(minus(corner(mesh, t, 1), corner(mesh, t, 0)), minus(corner(mesh, t, 2), corner(mesh, t, 0)));
    area += 0.5 * std::sqrt(dot(n, n));
  }
  return area;
}

VolumeMoments volume_moments(const TriangleMesh& mesh) {
  VolumeMoments m;
  if (mesh.triangles.empty()) return m;
  const Box3 box = bounding_box(mesh);
  Point3 c;
  for (std::size_t d = 0; d < 3; ++d) c[d] = box.lower[d] + 0.5 * (box.upper[d] - box.lower[d]);
  constexpr std::array<std::array<std::size_t, 2>, 6> pairs{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  Point3 first{};
  std::array<double, 6> second{};
  // Signed tetrahedra (centre, a, b, c): ∫ 1 = V, ∫ r = V s/4, ∫ r r = V (s s + Σ p p)/20 with s the sum of the
  // corners.
  for (const Triangle& t : mesh.triangles) {
    const std::array<Point3, 3> p{minus(corner(mesh, t, 0), c), minus(corner(mesh, t, 1), c),
                                  minus(corner(mesh, t, 2), c)};
    const double v = dot(p[0], cross(p[1], p[2])) / 6;
    m.volume += v;
    for (std::size_t d = 0; d < 3; ++d) first[d] += v * (p[0][d] + p[1][d] + p[2][d]) / 4;
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = pairs[e];
      const double sums = (p[0][a] + p[1][a] + p[2][a]) * (p[0][b] + p[1][b] + p[2][b]);
      second[e] += v * (sums + p[0][a] * p[0][b] + p[1][a] * p[1][b] + p[2][a] * p[2][b]) / 20;
    }
  }
  if (m.volume == 0) return m;
  for (std::size_t d = 0; d < 3; ++d) m.centroid[d] = c[d] + first[d] / m.volume;
  for (std::size_t e = 0; e < 6; ++e)
    m.second_moments[e] = second[e] - first[pairs[e][0]] * first[pairs[e][1]] / m.volume;
  return m;
}

Point3 way_to_triangle(const std::array<Point3, 3>& corners, const Point3& x) {
  const Point3& origin = corners[0];
  const Point3 n = cross(minus(corners[1], origin), minus(corners[2], origin));
  bool above = true;
  Point3 nearest{};
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const Point3& way) {
    if (const double distance = std::sqrt(dot(way, way)); distance < least) {
      least = distance;
      nearest = way;
    }
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Point3& a = corners[i];
    const Point3 ab = minus(corners[(i + 1) % 3], a), ax = minus(x, a);
    above = above && dot(cross(ab, ax), n) >= 0;
    const double length2 = dot(ab, ab);
    const double along = length2 > 0 ? std::clamp(dot(ax, ab) / length2, 0.0, 1.0) : 0;
    take({along * ab[0] - ax[0], along * ab[1] - ax[1], along * ab[2] - ax[2]});
  }
  if (const double area = std::sqrt(dot(n, n)); above && area > 0) {
    const Point3 normal{n[0] / area, n[1] / area, n[2] / area};
    const double height = dot(minus(x, origin), normal);
    take({-height * normal[0], -height * normal[1], -height * normal[2]});
  }
  return nearest;
}

Point3 way_to_triangle(const TriangleMesh& mesh, std::size_t t, const Point3& x) {
  const Triangle& triangle = mesh.triangles[t];
  return way_to_triangle({corner(mesh, triangle, 0), corner(mesh, triangle, 1), corner(mesh, triangle, 2)}, x);
}

double distance_to_triangle(const TriangleMesh& mesh, std::size_t t, const Point3& x) {
  const Point3 way = way_to_triangle(mesh, t, x);
  return std::sqrt(dot(way, way));
}

double distance_to_polygon(std::span<const Point3> polygon, const Point3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) {
    const Point3 way = way_to_triangle({polygon[0], polygon[a], polygon[a + 1]}, x);
    least = std::min(least, std::sqrt(dot(way, way)));
  }
  return least;
}

double solid_angle(const std::array<Point3, 3>& corners, const Point3& x) {
  const Point3 a = minus(corners[0], x), b = minus(corners[1], x), c = minus(corners[2], x);
  const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

} // namespace iga
