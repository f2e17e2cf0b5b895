#include "solver/estimate/oscillation.hpp"

#include <cassert>
#include <cmath>

namespace iga::solve {

namespace {

// B_0, B_1, … B_8.
constexpr double bernoulli_number[9] = {1, -0.5, 1.0 / 6, 0, -1.0 / 30, 0, 1.0 / 42, 0, -1.0 / 30};
constexpr int most = max_degree + 2;

double factorial(int n) {
  return n < 2 ? 1 : n * factorial(n - 1);
}

double binomial(int n, int k) {
  return factorial(n) / (factorial(k) * factorial(n - k));
}

// |B_2n| of n up to `most`, by ζ(2n).
double bernoulli_of_twice(int n) {
  double zeta = 0;
  for (int k = 400; k > 0; --k) zeta += std::pow(k, -2.0 * n);
  return 2 * factorial(2 * n) * zeta / std::pow(2 * M_PI, 2.0 * n);
}

} // namespace

Oscillation::Oscillation(int n) : n_(n) {
  assert(n >= 2 && n <= most && most <= 8);
  for (int k = 0; k <= n; ++k) coefficients_[k] = binomial(n, k) * bernoulli_number[n - k];
  // B_n' = n B_(n-1), ∫ B_m² = (m!)² |B_2m| / (2m)!
  const int m = n - 1;
  slope_squared_ = m == 1 ? 4.0 / 12 : n * n * factorial(m) * factorial(m) / factorial(2 * m) * bernoulli_of_twice(m);
}

double Oscillation::value(double t) const {
  double sum = coefficients_[n_];
  for (int k = n_ - 1; k >= 0; --k) sum = sum * t + coefficients_[k];
  return sum;
}

} // namespace iga::solve
