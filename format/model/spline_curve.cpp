// General refinement of spline curves (any inner multiplicities), by polar forms.
#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cassert>
#include <fmt/format.h>

namespace iga {

namespace {

using Args = std::vector<double>;

std::size_t order_of(const SplineCurve& curve) {
  return static_cast<std::size_t>(curve.degree);
}

// Knot index k with knots[k] <= u < knots[k + 1] inside the curve's domain; its last non-empty interval for u = end.
std::size_t interval_of(const SplineCurve& curve, double u) {
  const auto& U = curve.knots;
  const auto first = U.begin() + static_cast<std::ptrdiff_t>(order_of(curve));
  const auto last = U.begin() + static_cast<std::ptrdiff_t>(curve.coefficients.size());
  if (!(u >= *first && u <= *last))
    throw InputError(fmt::format("parameter {} lies outside the curve's domain {} … {}", u, *first, *last));
  auto it = std::upper_bound(first, last, u);
  if (it == last) it = std::lower_bound(first, last, *last);
  return static_cast<std::size_t>(it - U.begin()) - 1;
}

// Polar form of the polynomial piece on knot interval k: symmetric, affine in each of its p arguments.
// Ramshaw (1989), "Blossoms are polar forms", section 6: de Boor's triangle with one argument per level.
double blossom(const SplineCurve& curve, std::size_t k, const Args& args) {
  const std::size_t p = order_of(curve);
  assert(args.size() == p);
  std::vector<double> d(curve.coefficients.begin() + static_cast<std::ptrdiff_t>(k - p),
                        curve.coefficients.begin() + static_cast<std::ptrdiff_t>(k + 1));
  for (std::size_t r = 1; r <= p; ++r)
    for (std::size_t j = p; j >= r; --j) {
      const double lower = curve.knots[j + k - p], upper = curve.knots[j + k + 1 - r];
      const double alpha = (args[r - 1] - lower) / (upper - lower);
      d[j] = (1 - alpha) * d[j - 1] + alpha * d[j];
    }
  return d[p];
}

} // namespace

double evaluate(const SplineCurve& curve, double u) {
  return blossom(curve, interval_of(curve, u), Args(order_of(curve), u));
}

SplineCurve insert_knot(const SplineCurve& curve, double u) {
  const std::size_t p = order_of(curve), k = interval_of(curve, u);
  const auto& U = curve.knots;
  const auto multiplicity = static_cast<std::size_t>(std::count(U.begin(), U.end(), u));
  if (multiplicity >= p) throw InputError(fmt::format("knot {} already has multiplicity {}", u, multiplicity));
  SplineCurve refined{curve.degree, U, std::vector<double>(curve.coefficients.size() + 1)};
  refined.knots.insert(refined.knots.begin() + static_cast<std::ptrdiff_t>(k + 1), u);
  for (std::size_t i = 0; i < refined.coefficients.size(); ++i) {
    const double alpha = i + p <= k ? 1 : i + multiplicity > k ? 0 : (u - U[i]) / (U[i + p] - U[i]);
    double value = 0;
    if (alpha != 0) value += alpha * curve.coefficients[i];
    if (alpha != 1) value += (1 - alpha) * curve.coefficients[i - 1];
    refined.coefficients[i] = value;
  }
  return refined;
}

SplineCurve elevate_degree(const SplineCurve& curve) {
  const auto& U = curve.knots;
  const std::size_t q = order_of(curve) + 1;
  SplineCurve raised{curve.degree + 1, {}, {}};
  for (std::size_t i = 0; i < U.size(); ++i) {
    raised.knots.push_back(U[i]);
    if (i + 1 == U.size() || U[i] != U[i + 1]) raised.knots.push_back(U[i]);
  }
  const auto& T = raised.knots;
  for (std::size_t i = 0; i + q + 1 < T.size(); ++i) {
    // Coefficient i of the raised curve is its polar form at T[i+1] … T[i+q]: the mean over the q ways to leave one
    // out. Every piece between the first and the last argument gives the same value (the knots between appear often
    // enough).
    const std::size_t k = interval_of(curve, T[i + 1] < T[i + q] ? 0.5 * (T[i + 1] + T[i + q]) : T[i + 1]);
    double sum = 0;
    for (std::size_t left_out = 1; left_out <= q; ++left_out) {
      Args args;
      for (std::size_t j = 1; j <= q; ++j)
        if (j != left_out) args.push_back(T[i + j]);
      sum += blossom(curve, k, args);
    }
    raised.coefficients.push_back(sum / static_cast<double>(q));
  }
  return raised;
}

} // namespace iga
