// Compressible neo-Hookean solid: the law for large elastic deformation.
#pragma once

#include "solver/explicit/laws/lame.hpp"

namespace iga::solve {

/// ψ = μ/2 (F:F - 3) - μ ln J + λ/2 (ln J)², so P = μ F + p(J) cof F with p = (λ ln J - μ)/J (Bonet and Wood 2008,
/// 6.4.3). With the policy Clamp p goes on linearly below smallest_J (ψ is continued to second order in J), and
/// resist_crushing is added. The acoustic tensor is μ I + p'(J) c cᵀ, c = cof F · N.
struct NeoHookean {
  static constexpr int history = 0;
  static constexpr bool needs_old_F = false;

  double lambda = 0;  ///< force/length²
  double mu = 0;      ///< force/length²
  double density = 1; ///< mass/length³
  InversionPolicy inversion = {};

  void start(Lanes*) const {}
  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
  double reference_wave_speed() const { return plane_wave_speed(lambda, mu, density); }
  ElasticMaterial small_strain() const { return from_lame(lambda, mu, density); }
};

/// @throws InputError as isotropic()
NeoHookean neo_hookean(double E, double nu, double density, const InversionPolicy& inversion = {});

} // namespace iga::solve
