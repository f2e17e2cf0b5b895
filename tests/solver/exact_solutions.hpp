// Closed solutions of elasticity and the parts that they belong to.
#pragma once

#include "format/model/vec3.hpp"
#include "solver/mechanics/material.hpp"
#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace iga::test {

/// Of all solutions here; Young's modulus is 1.
constexpr double exact_nu = 0.3;

/// An eighth of a hollow sphere between radii a and b, n facets along each edge of the octant; or with `is_block` of a
/// cube of half edge b around a cavity of radius a.
inline TriangleMesh octant(double a, double b, int n, bool is_block = false) {
  TriangleMesh mesh;
  mesh.region_names = {"sphere"};
  const auto add = [&](const Point3& p, const Point3& q, const Point3& r) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Point3& x : {p, q, r}) mesh.vertices.push_back(x);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.region.push_back(0);
  };
  const auto on = [&](double radius, int i, int j) { // i along x, j along y, the rest along z
    const Point3 x{static_cast<double>(i), static_cast<double>(j), static_cast<double>(n - i - j)};
    return times(x, radius / (is_block && radius == b ? std::max({x[0], x[1], x[2]}) : norm(x)));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      add(on(b, i, j), on(b, i + 1, j), on(b, i, j + 1));
      add(on(a, i, j), on(a, i, j + 1), on(a, i + 1, j));
      if (i + j + 1 == n) continue;
      add(on(b, i + 1, j), on(b, i + 1, j + 1), on(b, i, j + 1));
      add(on(a, i + 1, j), on(a, i, j + 1), on(a, i + 1, j + 1));
    }
  const auto side = [&](const Point3& a0, const Point3& a1, const Point3& b0, const Point3& b1) {
    add(a0, b1, a1);
    add(a0, b0, b1);
  };
  for (int i = 0; i < n; ++i) {
    side(on(a, i + 1, 0), on(a, i, 0), on(b, i + 1, 0), on(b, i, 0));                         // y = 0
    side(on(a, 0, i), on(a, 0, i + 1), on(b, 0, i), on(b, 0, i + 1));                         // x = 0
    side(on(a, i, n - i), on(a, i + 1, n - i - 1), on(b, i, n - i), on(b, i + 1, n - i - 1)); // z = 0
  }
  return mesh;
}

/// Lamé: radii 1 and 2, pressure 1 inside.
inline Point3 sphere_displacement(const Point3& x) {
  const double r = norm(x);
  return times(x, ((1 - 2 * exact_nu) * r + (1 + exact_nu) * 8 / (2 * r * r)) / (7 * r));
}
inline solve::Voigt sphere_stress(const Point3& x) {
  const double r = norm(x), radial = (1 - 8 / (r * r * r)) / 7, hoop = (1 + 4 / (r * r * r)) / 7;
  solve::Voigt s;
  const auto entry = [&](std::size_t i, std::size_t j) {
    return (i == j ? hoop : 0.0) + (radial - hoop) * x[i] * x[j] / (r * r);
  };
  s << entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0);
  return s;
}

/// Kirsch: tension 1 along x, hole of radius 1, plane strain.
inline solve::Voigt kirsch_stress(const Point3& x) {
  const double r2 = x[0] * x[0] + x[1] * x[1], a2 = 1 / r2, a4 = a2 * a2;
  const double c2 = (x[0] * x[0] - x[1] * x[1]) / r2, s2 = 2 * x[0] * x[1] / r2;
  const double rr = 0.5 * (1 - a2) + 0.5 * (1 - 4 * a2 + 3 * a4) * c2;
  const double tt = 0.5 * (1 + a2) - 0.5 * (1 + 3 * a4) * c2;
  const double rt = -0.5 * (1 + 2 * a2 - 3 * a4) * s2;
  const double xx = 0.5 * (rr + tt) + 0.5 * (rr - tt) * c2 - rt * s2;
  const double yy = 0.5 * (rr + tt) - 0.5 * (rr - tt) * c2 + rt * s2;
  solve::Voigt s;
  s << xx, yy, exact_nu * (xx + yy), 0.5 * (rr - tt) * s2 + rt * c2, 0, 0;
  return s;
}

/// Radii 1 and 2, pressure 1 inside, plane strain.
inline solve::Voigt lame_stress(const Point3& x) {
  const double r2 = x[0] * x[0] + x[1] * x[1], radial = (1 - 4 / r2) / 3, hoop = (1 + 4 / r2) / 3;
  solve::Voigt s;
  s << (radial * x[0] * x[0] + hoop * x[1] * x[1]) / r2, (radial * x[1] * x[1] + hoop * x[0] * x[0]) / r2,
      exact_nu * (radial + hoop), (radial - hoop) * x[0] * x[1] / r2, 0, 0;
  return s;
}

/// A quarter of a prism around a hole of radius 1, n facets on each half of the quarter hole; `reach` is the outer
/// radius at a direction given by sine and cosine.
template <class Reach> TriangleMesh quarter_around_hole(int n, double thickness, Reach reach) {
  std::vector<std::array<double, 2>> polygon;
  const auto angle = [&](int k) { return k * std::numbers::pi / (4 * n); };
  for (int k = 0; k <= 2 * n; ++k) {
    const double s = std::sin(angle(k)), c = std::cos(angle(k)), r = reach(s, c);
    polygon.push_back({k == 2 * n ? 0 : r * c, k == 0 ? 0 : r * s});
  }
  for (int k = 2 * n; k >= 0; --k)
    polygon.push_back({k == 2 * n ? 0 : std::cos(angle(k)), k == 0 ? 0 : std::sin(angle(k))});
  std::vector<Triangle> triangles;
  for (int k = 0; k < 2 * n; ++k) {
    const int inner = 4 * n + 1 - k; // faces point k of the outside
    triangles.push_back({k, k + 1, inner});
    triangles.push_back({inner, k + 1, inner - 1});
  }
  return prism(polygon, triangles, 0, thickness);
}
/// Outside a square of half width 2.5.
inline TriangleMesh quarter_plate(int n, double thickness) {
  return quarter_around_hole(n, thickness, [](double s, double c) { return 2.5 / std::max(s, c); });
}
/// Outside a circle.
inline TriangleMesh quarter_ring(int n, double radius, double thickness) {
  return quarter_around_hole(n, thickness, [radius](double, double) { return radius; });
}

/// A spherical cavity of radius 1 in an endless body under tension 1 along z (Goodier 1933): displacement without that
/// of the tension. From Papkovich's potentials: 2 μ u = ∇(φ + z ψ) - 4 (1 - ν) ψ e_z, φ = A / r + B P_2 / r³, ψ = C z /
/// r³.
template <class Number> std::array<Number, 3> cavity_displacement(const std::array<Number, 3>& x) {
  constexpr double nu = exact_nu, D = 7 - 5 * nu, A = (6 - 5 * nu) / (2 * D), B = 1 / D, C = -5 / (2 * D);
  const Number z = x[2], r2 = x[0] * x[0] + x[1] * x[1] + z * z, r = std::sqrt(r2), r3 = r2 * r, r5 = r3 * r2,
               r7 = r5 * r2;
  std::array<Number, 3> u;
  for (std::size_t d = 0; d < 3; ++d) {
    u[d] = -A * x[d] / r3 - B * x[d] / r5 - 2.5 * B * (3.0 * z * z - r2) * x[d] / r7 - 3.0 * C * z * z * x[d] / r5;
    if (d == 2) u[d] += 3.0 * B * z / r5 + 2.0 * C * z / r3 - 4 * (1 - nu) * C * z / r3;
    u[d] *= 1 + nu; // 1 / 2 μ
  }
  return u;
}
/// Its stress; the largest is (27 - 15 ν) / (2 (7 - 5 ν)), along z on the equator.
inline solve::Voigt goodier_stress(const Point3& x) {
  using Complex = std::complex<double>;
  constexpr double step = 1e-30;
  Eigen::Matrix3d gradient; // by complex steps: exact to rounding
  for (std::size_t d = 0; d < 3; ++d) {
    std::array<Complex, 3> at{x[0], x[1], x[2]};
    at[d] += Complex(0, step);
    const auto u = cavity_displacement(at);
    for (std::size_t c = 0; c < 3; ++c)
      gradient(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(d)) = u[c].imag() / step;
  }
  solve::Voigt strain;
  strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
      gradient(1, 2) + gradient(2, 1), gradient(2, 0) + gradient(0, 2);
  solve::Voigt stress = solve::isotropic(1, exact_nu, 1).C * strain;
  stress[2] += 1;
  return stress;
}

} // namespace iga::test
