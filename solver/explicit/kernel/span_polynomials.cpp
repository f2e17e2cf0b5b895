#include "solver/explicit/kernel/span_polynomials.hpp"

#include <algorithm>
#include <array>

namespace iga::solve {

namespace {

using Polynomial = std::array<double, max_degree + 1>;

// result += factor (a + b t) x
void add_product(double factor, double a, double b, const Polynomial& x, Polynomial& result) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    result[k] += factor * a * x[k];
    if (k + 1 < x.size()) result[k + 1] += factor * b * x[k];
  }
}

} // namespace

SpanPolynomials span_polynomials(const KnotVector& knots, std::int64_t span) {
  const int p = knots.degree();
  const double lower = knots.lower(span), h = knots.upper(span) - lower;
  const auto first = static_cast<std::size_t>(span + p); // the knot at t = 0
  // Of cardinal functions the knots are whole numbers: rounded to them, so that all such spans share their polynomials.
  const bool cardinal = span >= p - 1 && span <= knots.num_spans() - p;
  const auto knot = [&](int offset) {
    if (cardinal) return static_cast<double>(offset);
    return (knots.values()[static_cast<std::size_t>(static_cast<int>(first) + offset)] - lower) / h;
  };
  std::array<Polynomial, max_degree + 1> N{};
  N[0][0] = 1;
  SpanPolynomials result;
  for (int degree = 1; degree <= p; ++degree) {
    std::array<Polynomial, max_degree + 1> next{};
    for (int r = 0; r < degree; ++r) {
      const double right = knot(r + 1), left = knot(r + 1 - degree);
      const auto a = static_cast<std::size_t>(r);
      add_product(1 / (right - left), right, -1, N[a], next[a]);
      add_product(1 / (right - left), -left, 1, N[a], next[a + 1]);
    }
    N = next;
  }
  const double size =
      cardinal ? (knots.values().back() - knots.values().front()) / static_cast<double>(knots.num_spans()) : h;
  for (std::size_t a = 0; a <= static_cast<std::size_t>(p); ++a)
    for (std::size_t k = 0; k <= static_cast<std::size_t>(p); ++k) {
      result.value[a][k] = N[a][k];
      if (k > 0) result.slope[a][k - 1] = static_cast<double>(k) * N[a][k] / size;
    }
  return result;
}

} // namespace iga::solve
