// Symmetric quadrature rules on a triangle: positive weights, all points strictly inside.
#pragma once

#include <array>
#include <span>

namespace iga {

/// One point of a rule: position l0 P0 + l1 P1 + l2 P2, weight relative to the triangle's area.
struct TrianglePoint {
  std::array<double, 3> barycentric{}; ///< all in (0, 1), sum 1
  double weight = 0;                   ///< > 0; the weights of a rule sum to 1
};

/// Highest total degree that triangle_rule offers: three times the highest spline degree.
constexpr int max_triangle_rule_degree = 12;

/// The smallest stored rule exact for all polynomials of total degree <= `degree`: 6 points up to degree 4, 12 up to 6,
/// 19 up to 9, 33 up to 12.
/// @pre 0 <= degree <= max_triangle_rule_degree
/// Dunavant (1985), High degree efficient symmetrical Gaussian quadrature rules for the triangle, appendix II; his
/// 15 digits were refined by Newton's method on the moment equations.
std::span<const TrianglePoint> triangle_rule(int degree);

} // namespace iga
