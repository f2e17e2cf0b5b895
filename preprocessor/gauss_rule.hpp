// One-dimensional Gaussian rules on [0, 1], and the polynomials that moments are taken with.
#pragma once

#include <vector>

namespace iga::prep {

/// Nodes ascending in (0, 1) and positive weights.
struct LineRule {
  std::vector<double> nodes;    ///< (n)
  std::vector<double> weights;  ///< (n)
};

/// Gauss–Legendre rule with n points on [0, 1]: exact to degree 2n - 1; weights sum to 1. The rule is computed once
/// (Newton on the Legendre polynomial) and kept. @pre 1 <= n <= 64
const LineRule& gauss_legendre(int n);

/// Gauss rule with n points for the weight (1 - s) on [0, 1]: exact to degree 2n - 1; weights sum to 1/2.
/// Golub & Welsch (1969) with the Jacobi(1, 0) recurrence. @pre 1 <= n <= 64
const LineRule& gauss_jacobi(int n);

/// Points and weights on the triangle with barycentric weights (1 - s - t, s, t): the collapsed product rule.
struct TriangleProductRule {
  std::vector<double> s, t;     ///< (n)
  std::vector<double> weights;  ///< (n); sum to 1 (relative to the triangle's area)
};

/// Exact to total degree `degree` on any triangle. Stroud (1971), conical product.
const TriangleProductRule& triangle_product_rule(int degree);

constexpr int max_moment_degree = 8;

/// Legendre polynomials on [0, 1] (|P_a| <= 1, P_a(1) = 1) up to degree q; works on doubles and on vectors of them.
template <class T> void legendre(const T& x, int q, T* P) {
  P[0] = x - x + 1.0;
  if (q == 0) return;
  const T t = 2.0 * x - 1.0;
  P[1] = t;
  for (int a = 1; a < q; ++a) P[a + 1] = ((2 * a + 1) * t * P[a] - a * P[a - 1]) * (1.0 / (a + 1));
}

/// Their antiderivatives G_a(x) = ∫_0^x P_a; G_0 = x, and G_a(0) = G_a(1) = 0 for a >= 1.
template <class T> void legendre_integrals(const T& x, int q, T* G) {
  T P[max_moment_degree + 2];
  legendre(x, q + 1, P);
  G[0] = x;
  for (int a = 1; a <= q; ++a) G[a] = (P[a + 1] - P[a - 1]) * (1.0 / (2 * (2 * a + 1)));
}

} // namespace iga::prep
