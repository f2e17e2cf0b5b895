// What the explicit kernel asks of a material law.
//
// Total Lagrangian: the kernel hands over the deformation gradient F = I + ∂u/∂X of eight points and takes back the
// first Piola–Kirchhoff stress P (force/length² of the reference area), so that f_int,i = Σ_g w_g P_g ∂N_i/∂X.
//
// A law is a plain struct with constants only; it holds no state of points. It provides:
//
//   static constexpr int history;         doubles per point that it keeps between steps (0 for hyperelastic laws)
//   static constexpr bool needs_old_F;    rate form: the kernel keeps F of the last step per point and hands it over
//   double density;                       mass / reference volume
//
//   void start(Lanes* h) const;           history of eight untouched points; h[k] is component k
//   void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
//
// and `reference_wave_speed()`: √(max eigenvalue of the acoustic tensor / density) at F = I with a fresh history; it is
// what the Lanczos estimate of the time step at the start is scaled by. `small_strain()` gives the elastic constants
// that this estimate works with. A law with an equivalent plastic strain says where it lies in the history:
// `static constexpr int plastic_strain`. All laws: laws/laws.hpp.
#pragma once

#include "solver/explicit/simd/tensor_lanes.hpp"

namespace iga::solve {

struct LawInput {
  TensorLanes F;     ///< at t_{n+1}
  TensorLanes F_old; ///< at t_n; laws with needs_old_F (and bulk viscosity) only
  double dt = 0;     ///< t_{n+1} - t_n; 0 in the first evaluation of a run (no rates)
  double length = 0; ///< characteristic length in the reference: the smallest side of a span
};

/// Per point, beside the stress.
struct LawOutput {
  /// c²: the largest eigenvalue over all directions N of the acoustic tensor N_B (∂P_aB/∂F_bD) N_D / density, or an
  /// upper bound that is tight at F = I; in the metric of the reference, so that
  /// dt ≤ dt_start · reference_wave_speed / c. Includes the part of F^-T; speed², (length/time)².
  Lanes wave_speed_squared;
  Lanes J;           ///< det F as the law saw it
  LaneMask inverted; ///< the law was not evaluated at this J: see InversionPolicy in laws/inversion.hpp
  /// Viscous (rate) share of the power: damping stress : D · J, power / reference volume; 0 without damping. The rest
  /// of P : Ḟ is internal energy and plastic work.
  Lanes viscous_power;
  /// Stiffness-like share of a damping: ξ of dt ≤ dt_0 (√(1 + ξ²) - ξ) for ω_max = 2 c / length; 0 without damping.
  /// Where the untouched body has ω_max length / (2 c) = κ, the ratio is κ ξ.
  Lanes damping_ratio;
  /// Volume or thickness that a crushed point (laws/compaction.hpp) lost in this step, as a share of what is left: the
  /// next step shall be so short that it loses no more than a quarter. 0 where F of the last step is not known.
  Lanes compression;
};

} // namespace iga::solve
