// The B-splines of one span as polynomials: what is evaluated anew at every point of a trimmed span, every step.
#pragma once

#include "format/model/knot_vector.hpp"

namespace iga::solve {

/// The p + 1 functions that do not vanish on one span, in t = (u - lower) / h, 0 … 1 inside it. [function][power of t];
/// well conditioned, as p <= 4. All spans that no repeated end knot reaches have the same ones.
struct SpanPolynomials {
  double value[max_degree + 1][max_degree + 1] = {};
  double slope[max_degree + 1][max_degree + 1] = {}; ///< d/du, 1/length; power p - 1 is the last

  bool operator==(const SpanPolynomials&) const = default;
};

/// Cox–de Boor with polynomials in the place of numbers: Piegl & Tiller (1997), algorithm A2.2.
SpanPolynomials span_polynomials(const KnotVector& knots, std::int64_t span);

} // namespace iga::solve
