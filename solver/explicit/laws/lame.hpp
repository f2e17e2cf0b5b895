// What laws with two elastic constants and no history share.
#pragma once

#include "solver/explicit/laws/inversion.hpp"
#include "solver/mechanics/material.hpp"

#include <cmath>

namespace iga::solve {

/// Of plane waves, length/time.
inline double plane_wave_speed(double lambda, double mu, double density) {
  return std::sqrt((lambda + 2 * mu) / density);
}

inline ElasticMaterial from_lame(double lambda, double mu, double density) {
  return isotropic(mu * (3 * lambda + 2 * mu) / (lambda + mu), lambda / (2 * (lambda + mu)), density);
}

/// @throws InputError as isotropic()
template <class Law> Law hyperelastic(double E, double nu, double density, const InversionPolicy& inversion) {
  const ElasticMaterial m = isotropic(E, nu, density);
  return {.lambda = m.C(0, 1), .mu = m.C(3, 3), .density = density, .inversion = inversion};
}

} // namespace iga::solve
