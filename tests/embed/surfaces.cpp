#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

namespace iga::test {

TriangleMesh box(const Point3& lower, const Point3& upper) {
  TriangleMesh m;
  for (std::size_t c = 0; c < 8; ++c)
    m.vertices.push_back({c & 1 ? upper[0] : lower[0], c & 2 ? upper[1] : lower[1], c & 4 ? upper[2] : lower[2]});
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"box"};
  return m;
}

TriangleMesh sphere(const Point3& centre, double radius, int levels) {
  TriangleMesh m;
  m.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
    const auto mid = [&](std::int32_t a, std::int32_t b) {
      const auto [it, added] = middle.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(m.vertices.size()));
      if (added) {
        const Point3 &p = m.vertices[static_cast<std::size_t>(a)], &q = m.vertices[static_cast<std::size_t>(b)];
        Point3 s{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        const double r = std::hypot(s[0], s[1], s[2]);
        for (double& c : s) c /= r;
        m.vertices.push_back(s);
      }
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : m.triangles) {
      const auto a = mid(t[0], t[1]), b = mid(t[1], t[2]), c = mid(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    m.triangles = finer;
  }
  for (Point3& v : m.vertices)
    for (std::size_t d = 0; d < 3; ++d) v[d] = centre[d] + radius * v[d];
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"sphere"};
  return m;
}

TriangleMesh prism(const std::vector<std::array<double, 2>>& polygon, const std::vector<Triangle>& triangles, double z0,
                   double z1) {
  TriangleMesh m;
  const auto n = static_cast<std::int32_t>(polygon.size());
  for (const double z : {z0, z1})
    for (const auto& p : polygon) m.vertices.push_back({p[0], p[1], z});
  for (const Triangle& t : triangles) {
    m.triangles.push_back({t[0], t[2], t[1]});
    m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  for (std::int32_t a = 0; a < n; ++a) {
    const std::int32_t b = (a + 1) % n;
    m.triangles.push_back({a, b, b + n});
    m.triangles.push_back({a, b + n, a + n});
  }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"prism"};
  return m;
}

TriangleMesh join(const std::vector<TriangleMesh>& bodies) {
  TriangleMesh all;
  for (const TriangleMesh& b : bodies) {
    const auto shift = static_cast<std::int32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const Triangle& t : b.triangles) {
      all.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
      all.region.push_back(static_cast<std::int32_t>(all.region_names.size()));
    }
    all.region_names.push_back("body " + std::to_string(all.region_names.size()));
  }
  return all;
}

TriangleMesh transformed(TriangleMesh mesh, const Rotation& R, const Point3& shift) {
  for (Point3& v : mesh.vertices) {
    const Point3 p = v;
    for (std::size_t r = 0; r < 3; ++r) v[r] = shift[r] + R[r][0] * p[0] + R[r][1] * p[1] + R[r][2] * p[2];
  }
  return mesh;
}

TriangleMesh flipped(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

Rotation rotation(double about_z, double about_y) {
  const double a = about_z * std::numbers::pi / 180, b = about_y * std::numbers::pi / 180;
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
  return {{{cb * ca, -cb * sa, sb}, {sa, ca, 0}, {-sb * ca, sb * sa, cb}}};
}

SplineGrid grid_around(const TriangleMesh& mesh, double size, int degree, double shift, const Rotation& R) {
  Point3 lower, upper;
  const Box3 box = bounding_box(mesh);
  // A rotated grid about the part's centre holds the part's bounding sphere.
  const double half_diagonal =
      0.5 * std::hypot(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]);
  Index3 n;
  for (std::size_t d = 0; d < 3; ++d) {
    const double centre = 0.5 * (box.lower[d] + box.upper[d]);
    lower[d] = R == identity_rotation ? box.lower[d] : centre - half_diagonal;
    upper[d] = R == identity_rotation ? box.upper[d] : centre + half_diagonal;
    n[d] = static_cast<std::int64_t>(std::ceil((upper[d] - lower[d]) / size - 1e-9)) + 2 * degree + 1;
    lower[d] -= size * (degree + shift);
    upper[d] = lower[d] + size * static_cast<double>(n[d]);
  }
  return SplineGrid(lower, upper, n, {degree, degree, degree}, R);
}

SplineGrid grid_with(const TriangleMesh& mesh, int count, int degree) {
  const Box3 b = bounding_box(mesh);
  const double side = std::max({b.upper[0] - b.lower[0], b.upper[1] - b.lower[1], b.upper[2] - b.lower[2]});
  return grid_around(mesh, side / count, degree);
}

namespace {

std::vector<Point3> read_corners(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  std::vector<Point3> corners;
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() != 84 + 50 * std::size_t{count}) { // ASCII
    std::istringstream words(bytes);
    for (std::string word; words >> word;)
      if (Point3 p; word == "vertex" && words >> p[0] >> p[1] >> p[2]) corners.push_back(p);
    return corners;
  }
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t a = 0; a < 3; ++a) {
      std::array<float, 3> p;
      std::memcpy(p.data(), bytes.data() + 84 + 50 * t + 12 + 12 * a, 12);
      corners.push_back({p[0], p[1], p[2]});
    }
  return corners;
}

} // namespace

TriangleMesh read_stl(const std::filesystem::path& file, double weld) {
  TriangleMesh m;
  const std::vector<Point3> corners = read_corners(file);
  if (corners.empty()) return m;
  Point3 lower = corners[0], upper = corners[0];
  for (const Point3& p : corners)
    for (std::size_t d = 0; d < 3; ++d) {
      lower[d] = std::min(lower[d], p[d]);
      upper[d] = std::max(upper[d], p[d]);
    }
  const double size = std::hypot(upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]);
  std::map<Point3, std::int32_t> number;
  std::map<Index3, std::int32_t> cells;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    std::int32_t v = -1;
    if (weld == 0) {
      v = number.try_emplace(corners[c], static_cast<std::int32_t>(m.vertices.size())).first->second;
    } else {
      const double w = weld * size;
      Index3 home;
      for (std::size_t d = 0; d < 3; ++d)
        home[d] = static_cast<std::int64_t>(std::floor((corners[c][d] - lower[d]) / w));
      for (std::int64_t q = 0; q < 27 && v < 0; ++q) {
        const auto it = cells.find({home[0] + q % 3 - 1, home[1] + q / 3 % 3 - 1, home[2] + q / 9 - 1});
        if (it == cells.end()) continue;
        const Point3& p = m.vertices[static_cast<std::size_t>(it->second)];
        if (std::hypot(p[0] - corners[c][0], p[1] - corners[c][1], p[2] - corners[c][2]) <= w) v = it->second;
      }
      if (v < 0) cells[home] = v = static_cast<std::int32_t>(m.vertices.size());
    }
    if (static_cast<std::size_t>(v) == m.vertices.size()) m.vertices.push_back(corners[c]);
    if (c % 3 == 0) m.triangles.push_back({});
    m.triangles.back()[c % 3] = v;
  }
  std::erase_if(m.triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"part"};
  return m;
}

std::filesystem::path shared_part(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(IGA_SHARED_DIR) / "stl" / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path{};
}

double weld_of(const std::string& name) {
  for (const char* coarse : {"angle_block.STL", "featuretype.STL", "idler_riser.STL", "octagonal_pocket.stl"})
    if (name == coarse) return 1e-6;
  return 0;
}

double diagonal(const TriangleMesh& mesh) {
  const Box3 b = bounding_box(mesh);
  return std::hypot(b.upper[0] - b.lower[0], b.upper[1] - b.lower[1], b.upper[2] - b.lower[2]);
}

} // namespace iga::test
