// When displacements alone are hard put to describe a material.
#pragma once

#include "solver/mechanics/material.hpp"

#include <cmath>

namespace iga::solve {

/// Isotropic, with a Poisson's ratio from 0.49 on?
inline bool is_nearly_incompressible(const ElasticMaterial& material) {
  const double lambda = material.C(0, 1), mu = material.C(3, 3);
  constexpr double least = 0.49, rounding = 1e-9;
  const double off = std::abs(material.C(0, 0) - lambda - 2 * mu) + std::abs(material.C(1, 2) - lambda);
  return off < rounding * material.C(0, 0) && lambda > 2 * (least - rounding) * (lambda + mu); // ν = λ / (2 (λ + μ))
}

} // namespace iga::solve
