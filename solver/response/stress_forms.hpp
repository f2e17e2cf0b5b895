// Von Mises stress of what varies: its largest value over a cycle, its root mean square.
#pragma once

#include "solver/mechanics/material.hpp"

#include <cmath>

namespace iga::solve {

/// aᵀ A b with σ_v² = σᵀ A σ.
inline double von_mises_product(const Voigt& a, const Voigt& b) {
  const double mean_a = (a[0] + a[1] + a[2]) / 3, mean_b = (b[0] + b[1] + b[2]) / 3;
  double sum = 0;
  for (Eigen::Index k = 0; k < 3; ++k) sum += 1.5 * (a[k] - mean_a) * (b[k] - mean_b) + 3 * a[k + 3] * b[k + 3];
  return sum;
}

/// Largest value of √(x(t)ᵀ A x(t)) over a cycle of x = a cos ωt + b sin ωt, from aᵀ A a, bᵀ A b and aᵀ A b: it is
/// (aa + bb) / 2 + ((aa - bb) / 2) cos 2ωt + ab sin 2ωt under the root.
inline double cycle_maximum(double aa, double bb, double ab) {
  return std::sqrt(std::max(0.0, (aa + bb) / 2 + std::hypot((aa - bb) / 2, ab)));
}

/// Largest von Mises stress over a cycle of the stress Re(amplitude e^(iωt)).
inline double von_mises_over_cycle(const Voigt& real, const Voigt& imaginary) {
  return cycle_maximum(von_mises_product(real, real), von_mises_product(imaginary, imaginary),
                       von_mises_product(real, imaginary));
}

} // namespace iga::solve
