// One-dimensional Gaussian rules on [0, 1], and the polynomials that moments are taken with.
#pragma once

#include <type_traits>
#include <vector>

namespace iga::prep {

/// Nodes ascending in (0, 1) and positive weights.
struct LineRule {
  std::vector<double> nodes;   ///< (n)
  std::vector<double> weights; ///< (n)
};

/// Gauss–Legendre rule with n points on [0, 1]: exact to degree 2n - 1; weights sum to 1. Computed once and kept.
/// Eigenvalues of the Jacobi matrix (Golub & Welsch 1969), polished by Newton in extended precision. @pre 1 <= n <= 64
const LineRule& gauss_legendre(int n);

/// Points and weights on the triangle with barycentric weights (1 - s - t, s, t): the collapsed product of a
/// Gauss–Legendre rule and a Gauss rule for the weight 1 - s.
template <class T> struct TriangleProductRule {
  std::vector<T> s, t;    ///< (n)
  std::vector<T> weights; ///< (n); sum to 1 (relative to the triangle's area)
};

/// Exact to total degree `degree` on any triangle. Stroud (1971), conical product. T: double or long double.
template <class T> const TriangleProductRule<T>& triangle_product_rule(int degree);

constexpr int max_moment_degree = 8;

/// Constants in the precision of what they multiply: extended sums of thin parts must not see a rounded third.
template <class T> using ConstantOf = std::conditional_t<std::is_same_v<T, long double>, long double, double>;

/// Legendre polynomials on [0, 1] (|P_a| <= 1, P_a(1) = 1) up to degree q; works on doubles and on vectors of them.
template <class T> void legendre(const T& x, int q, T* P) {
  P[0] = T{} + 1.0;
  if (q == 0) return;
  using Constant = ConstantOf<T>;
  const T t = 2.0 * x - 1.0;
  P[1] = t;
  for (int a = 1; a < q; ++a) P[a + 1] = ((2 * a + 1) * t * P[a] - a * P[a - 1]) * (Constant(1) / (a + 1));
}

/// Their slopes from their values: P'_{a+1} = P'_{a-1} + 2 (2a + 1) P_a.
template <class T> void legendre_slopes(int q, const T* P, T* D) {
  D[0] = T{};
  if (q > 0) D[1] = T{} + 2.0;
  for (int a = 1; a < q; ++a) D[a + 1] = D[a - 1] + 2.0 * (2 * a + 1) * P[a];
}

/// Their antiderivatives G_a(x) = ∫_0^x P_a; G_0 = x, and G_a(0) = G_a(1) = 0 for a >= 1.
template <class T> void legendre_integrals(const T& x, int q, T* G) {
  T P[max_moment_degree + 2];
  legendre(x, q + 1, P);
  G[0] = x;
  for (int a = 1; a <= q; ++a) G[a] = (P[a + 1] - P[a - 1]) * (ConstantOf<T>(1) / (2 * (2 * a + 1)));
}

} // namespace iga::prep
