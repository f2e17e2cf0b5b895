// Periodic Bernoulli polynomials: the shape of what a spline of degree p leaves of a smooth field inside its spans.
#pragma once

#include "format/model/knot_vector.hpp"

namespace iga::solve {

/// B_n(t) with the period 1, n = 2 … max_degree + 2; ∫ over a period = 0.
/// On equal knots the error of splines of degree p is, to leading order, a smooth field times the n = p + 1 one of them
/// in each direction (de Boor, A Practical Guide to Splines, 1978, chapter XII).
class Oscillation {
 public:
  explicit Oscillation(int n);
  double value(double t) const;                           ///< t in [0, 1]
  double slope_squared() const { return slope_squared_; } ///< ∫ B_n'² over a period

 private:
  int n_;
  double coefficients_[max_degree + 3] = {};
  double slope_squared_;
};

} // namespace iga::solve
