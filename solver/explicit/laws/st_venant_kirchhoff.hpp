// St. Venant–Kirchhoff solid: Hooke's law between Green's strain and the second Piola–Kirchhoff stress.
#pragma once

#include "solver/explicit/laws/lame.hpp"

namespace iga::solve {

/// S = λ tr(E) I + 2 μ E, E = (FᵀF - I)/2, P = F S: large rotations, moderate strains. In compression it softens and is
/// unstable below a stretch of √⅓ = 0.577. With the policy Clamp a pressure M (J / smallest_J - 1) and resist_crushing
/// are added below smallest_J (on top of the law, which is finite for every F).
struct StVenantKirchhoff {
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
StVenantKirchhoff st_venant_kirchhoff(double E, double nu, double density, const InversionPolicy& inversion = {});

} // namespace iga::solve
