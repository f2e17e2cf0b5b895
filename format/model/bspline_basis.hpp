// B-spline values and derivatives on one span: the rule that gives the numbers in the file their meaning.
#pragma once

#include "format/model/knot_vector.hpp"

#include <span>
#include <vector>

namespace iga {

/// Values at `u` of the p + 1 B-spline functions that do not vanish on one span.
/// @param[in]  span    0-based span number; u may lie outside it (polynomial continuation)
/// @param[out] values  (p + 1); entry a belongs to function `span + a`; the entries sum to 1
/// Cox–de Boor recursion in triangular order: Piegl & Tiller, The NURBS Book (1997), algorithm A2.2.
void evaluate_basis(const KnotVector& knots, std::int64_t span, double u, std::span<double> values);

/// First derivatives d/du of the same functions (1/parameter).
/// @param[out] derivatives  (p + 1); the entries sum to 0
/// Piegl & Tiller (1997), equation 2.7.
void evaluate_basis_derivatives(const KnotVector& knots, std::int64_t span, double u, std::span<double> derivatives);

/// ∫ N over one span for its p + 1 functions; (p + 1) values in parameter units.
void integrate_basis(const KnotVector& knots, std::int64_t span, std::span<double> integrals);

/// Polar form (blossom) of the spline on one span: Σ weights[a] c_a is the blossom at `arguments` of the polynomial
/// with the coefficients c_a of the functions span … span + p. The coefficient of function i of any spline that equals
/// the polynomial is the blossom at the inner knots i + 1 … i + p; a Bernstein coefficient that at the ends of its
/// span, repeated. De Boor's algorithm with one argument per level (Ramshaw 1989).
/// @param[in]  arguments  (p), in any order
/// @param[out] weights    (p + 1); they sum to 1
void blossom_weights(const KnotVector& knots, std::int64_t span, std::span<const double> arguments,
                     std::span<double> weights);
/// The same for a polynomial given by its p + 1 Bernstein coefficients on [a, b]: de Casteljau's algorithm.
void bernstein_blossom_weights(double a, double b, std::span<const double> arguments, std::span<double> weights);
/// The k-th of the p + 1 Bernstein coefficients on a span from those of its B-splines: a row of Bézier extraction.
/// @param[out] weights  (p + 1)
void bernstein_weights(const KnotVector& knots, std::int64_t span, int k, std::span<double> weights);

/// A spline curve's coefficients on a knot vector of arbitrary multiplicities: the general form that refinement works
/// on.
struct SplineCurve {
  int degree = 1;
  std::vector<double> knots;        ///< (n + degree + 1), ascending
  std::vector<double> coefficients; ///< (n)
};

/// Value of the curve at u. @throws InputError unless knots[degree] <= u <= knots[n]
double evaluate(const SplineCurve& curve, double u);
/// The same curve with `u` inserted once. Boehm (1980); Piegl & Tiller (1997), equation 5.15.
/// @throws InputError where u lies outside the curve or its multiplicity already equals the degree
SplineCurve insert_knot(const SplineCurve& curve, double u);
/// The same curve with the degree raised by one; every knot's multiplicity grows by one. Works on any clamped knot
/// vector with inner multiplicities up to the degree (through polar forms: Ramshaw 1989).
SplineCurve elevate_degree(const SplineCurve& curve);

} // namespace iga
