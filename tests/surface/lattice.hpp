// A lattice of struts: many bodies that overlap in nodes.
#pragma once

#include "format/model/vec3.hpp"
#include "tests/surface/shapes.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace iga::test {

/// A hexagonal prism around the line from a to b.
struct Strut {
  Point3 a{}, b{};
  double radius = 1; ///< of the corners

  Point3 axis() const { return times(minus(b, a), 1 / norm(minus(b, a))); }
  std::array<Point3, 2> across() const {
    const Point3 c = cross(axis(), Point3{0.36, 0.48, 0.8});
    const Point3 u = times(c, 1 / norm(c));
    return {u, cross(axis(), u)};
  }
  bool contains(const Point3& x) const {
    const Point3 r = minus(x, a);
    const double along = dot(r, axis());
    if (along < 0 || along > norm(minus(b, a)) || dot(r, r) - along * along > radius * radius) return false;
    const auto [u, v] = across();
    for (int i = 0; i < 6; ++i) {
      const double angle = (i + 0.5) * std::numbers::pi / 3;
      if (dot(r, plus(times(u, std::cos(angle)), times(v, std::sin(angle)))) > radius * std::sqrt(0.75)) return false;
    }
    return true;
  }
  Soup facets() const {
    const auto [u, v] = across();
    std::array<std::array<Point3, 6>, 2> ring;
    for (std::size_t i = 0; i < 6; ++i) {
      const double angle = static_cast<double>(i) * std::numbers::pi / 3;
      const Point3 r = times(plus(times(u, std::cos(angle)), times(v, std::sin(angle))), radius);
      ring[0][i] = plus(a, r);
      ring[1][i] = plus(b, r);
    }
    Soup out;
    for (std::size_t i = 0; i < 6; ++i) {
      const std::size_t j = (i + 1) % 6;
      out.push_back({ring[0][i], ring[0][j], ring[1][j]});
      out.push_back({ring[0][i], ring[1][j], ring[1][i]});
      if (i == 0 || j == 0) continue;
      out.push_back({ring[0][0], ring[0][j], ring[0][i]});
      out.push_back({ring[1][0], ring[1][i], ring[1][j]});
    }
    return out;
  }
};

/// The 8 n³ struts from the centres of n × n × n cells of size 10 to the cells' corners.
inline std::vector<Strut> body_centred_lattice(int n) {
  std::vector<Strut> out;
  for (int i = 0; i < n * n * n; ++i) {
    const Point3 centre{10.0 * (i % n) + 5, 10.0 * (i / n % n) + 5, 10.0 * (i / n / n) + 5};
    for (int c = 0; c < 8; ++c)
      out.push_back({centre, plus(centre, Point3{(c & 1) ? 5.0 : -5, (c & 2) ? 5.0 : -5, (c & 4) ? 5.0 : -5})});
  }
  return out;
}

inline Soup facets_of(const std::vector<Strut>& struts) {
  Soup out;
  for (const Strut& s : struts) out = std::move(out) + s.facets();
  return out;
}

} // namespace iga::test
