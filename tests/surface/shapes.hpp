// Small surfaces that the surface tests build on.
#pragma once

#include "preprocessor/surface/read_mesh.hpp"

#include <array>
#include <vector>

namespace iga::test {

using Soup = std::vector<std::array<Point3, 3>>;

/// The twelve outward facets of a box.
inline Soup box_facets(const Point3& lower, const Point3& upper) {
  const auto p = [&](int i) {
    return Point3{(i & 1) ? upper[0] : lower[0], (i & 2) ? upper[1] : lower[1], (i & 4) ? upper[2] : lower[2]};
  };
  constexpr std::array<std::array<int, 4>, 6> quads{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  Soup out;
  for (const auto& q : quads) {
    out.push_back({p(q[0]), p(q[1]), p(q[2])});
    out.push_back({p(q[0]), p(q[2]), p(q[3])});
  }
  return out;
}

inline Soup turned(Soup soup) {
  for (auto& t : soup) std::swap(t[1], t[2]);
  return soup;
}

inline Soup operator+(Soup a, const Soup& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// x → factor · x + shift
inline Soup moved(Soup soup, double factor, const Point3& shift) {
  for (auto& t : soup)
    for (Point3& x : t)
      for (std::size_t d = 0; d < 3; ++d) x[d] = factor * x[d] + shift[d];
  return soup;
}

/// As a reader delivers it: three own vertices per facet, no stored normals.
inline prep::ReadMesh as_read(const Soup& soup) {
  prep::ReadMesh out;
  out.file = "test.stl";
  out.mesh.region_names = {"surface"};
  for (const auto& t : soup) {
    const auto v = static_cast<std::int32_t>(out.mesh.vertices.size());
    for (const Point3& x : t) out.mesh.vertices.push_back(x);
    out.mesh.triangles.push_back({v, v + 1, v + 2});
    out.mesh.region.push_back(0);
    out.facet_normals.push_back({});
  }
  return out;
}

} // namespace iga::test
