#include "format/model/bspline_basis.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace iga {

namespace {

constexpr std::size_t max_order = max_degree + 1;

// The non-vanishing functions of degree `degree` at u, in the triangular order of algorithm A2.2.
void values_of_degree(std::span<const double> knots, std::size_t last_knot, int degree, double u, double* values) {
  std::array<double, max_order> left{}, right{};
  values[0] = 1;
  for (std::size_t j = 1; j <= static_cast<std::size_t>(degree); ++j) {
    left[j] = u - knots[last_knot + 1 - j];
    right[j] = knots[last_knot + j] - u;
    double saved = 0;
    for (std::size_t r = 0; r < j; ++r) {
      const double ratio = values[r] / (right[r + 1] + left[j - r]);
      values[r] = saved + right[r + 1] * ratio;
      saved = left[j - r] * ratio;
    }
    values[j] = saved;
  }
}

} // namespace

void evaluate_basis(const KnotVector& knots, std::int64_t span, double u, std::span<double> values) {
  assert(values.size() == static_cast<std::size_t>(knots.degree() + 1));
  values_of_degree(knots.values(), static_cast<std::size_t>(span + knots.degree()), knots.degree(), u, values.data());
}

void evaluate_basis_derivatives(const KnotVector& knots, std::int64_t span, double u, std::span<double> derivatives) {
  const int p = knots.degree();
  assert(derivatives.size() == static_cast<std::size_t>(p + 1));
  const auto U = knots.values();
  const auto e = static_cast<std::size_t>(span + p);
  std::array<double, max_order> lower{};
  values_of_degree(U, e, p - 1, u, lower.data());
  for (std::size_t a = 0; a <= static_cast<std::size_t>(p); ++a) {
    // Function i = span + a has knots U[i] … U[i + p + 1]; the two lower-degree functions it is made of:
    const std::size_t i = static_cast<std::size_t>(span) + a;
    const auto pd = static_cast<std::size_t>(p);
    double d = 0;
    if (a > 0) d += lower[a - 1] / (U[i + pd] - U[i]);
    if (a < pd) d -= lower[a] / (U[i + pd + 1] - U[i + 1]);
    derivatives[a] = p * d;
  }
}

void blossom_weights(const KnotVector& knots, std::int64_t span, std::span<const double> arguments,
                     std::span<double> weights) {
  const auto U = knots.values();
  const auto degree = static_cast<std::size_t>(knots.degree());
  assert(arguments.size() == degree && weights.size() == degree + 1);
  const auto k = static_cast<std::size_t>(span) + degree; // U[k] … U[k + 1] is the span
  for (std::size_t b = 0; b <= degree; ++b) {
    std::array<double, max_order> c{};
    c[b] = 1;
    for (std::size_t level = 1; level <= degree; ++level) {
      const double t = arguments[level - 1];
      for (std::size_t j = degree; j >= level; --j) {
        const double left = U[k - degree + j], right = U[k + 1 + j - level];
        c[j] = ((right - t) * c[j - 1] + (t - left) * c[j]) / (right - left);
      }
    }
    weights[b] = c[degree];
  }
}

void bernstein_blossom_weights(double a, double b, std::span<const double> arguments, std::span<double> weights) {
  const std::size_t degree = arguments.size();
  assert(weights.size() == degree + 1 && degree < max_order);
  for (std::size_t i = 0; i <= degree; ++i) {
    std::array<double, max_order> c{};
    c[i] = 1;
    for (std::size_t level = 1; level <= degree; ++level) {
      const double t = (arguments[level - 1] - a) / (b - a);
      for (std::size_t j = degree; j >= level; --j) c[j] = (1 - t) * c[j - 1] + t * c[j];
    }
    weights[i] = c[degree];
  }
}

void bernstein_weights(const KnotVector& knots, std::int64_t span, int k, std::span<double> weights) {
  std::array<double, max_degree> ends;
  ends.fill(knots.lower(span));
  std::fill_n(ends.begin(), k, knots.upper(span));
  blossom_weights(knots, span, std::span(ends).first(static_cast<std::size_t>(knots.degree())), weights);
}

void integrate_basis(const KnotVector& knots, std::int64_t span, std::span<double> integrals) {
  // Gauss–Legendre with three points is exact to degree 5 > max_degree.
  constexpr std::array<double, 3> x{0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array<double, 3> w{5.0 / 18, 8.0 / 18, 5.0 / 18};
  std::array<double, max_order> values{};
  const double a = knots.lower(span), h = knots.upper(span) - a;
  for (double& v : integrals) v = 0;
  for (std::size_t q = 0; q < 3; ++q) {
    evaluate_basis(knots, span, a + h * x[q], std::span(values).first(integrals.size()));
    for (std::size_t i = 0; i < integrals.size(); ++i) integrals[i] += w[q] * h * values[i];
  }
}

} // namespace iga
