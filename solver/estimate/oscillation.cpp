#include "solver/estimate/oscillation.hpp"

#include <cassert>
#include <cmath>

namespace iga::solve {

namespace {

// B_0, B_1, … B_10.
constexpr double bernoulli_number[11] = {1, -0.5, 1.0 / 6, 0, -1.0 / 30, 0, 1.0 / 42, 0, -1.0 / 30, 0, 5.0 / 66};
constexpr int most = max_degree + 2;

double factorial(int n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}

double binomial(int n, int k) {
  return factorial(n) / (factorial(k) * factorial(n - k));
}

} // namespace

Oscillation::Oscillation(int n) : n_(n) {
  static_assert(2 * (most - 1) <= 10);
  assert(n >= 2 && n <= most);
  for (int k = 0; k <= n; ++k) coefficients_[k] = binomial(n, k) * bernoulli_number[n - k];
  // B_n' = n B_(n-1), ∫ B_m² = (m!)² |B_2m| / (2m)!
  const int m = n - 1;
  slope_squared_ = n * n * factorial(m) * factorial(m) / factorial(2 * m) * std::abs(bernoulli_number[2 * m]);
}

double Oscillation::value(double t) const {
  double sum = coefficients_[n_];
  for (int k = n_ - 1; k >= 0; --k) sum = sum * t + coefficients_[k];
  return sum;
}

} // namespace iga::solve
