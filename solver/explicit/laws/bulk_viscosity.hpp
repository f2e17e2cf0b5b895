// Bulk viscosity around any law: a pressure against compression that spreads shocks over a few spans (numerics 6.4).
#pragma once

#include "solver/explicit/laws/law.hpp"
#include "solver/explicit/simd/pack_math.hpp"
#include "solver/explicit/simd/pack_tensor.hpp"
#include "solver/mechanics/material.hpp"

namespace iga::solve {

/// Adds q = (ρ0/J) l (Q1 l (tr D)² - Q2 c tr D) where tr D < 0, with l = h J^{1/3} and c the wave speed of the law in
/// space (von Neumann and Richtmyer 1950; the linear term of Landshoff 1955). tr D = 2 (J - J_old) / ((J + J_old) Δt).
/// Points that are or were inverted get none.
template <class BaseLaw> struct BulkViscosity {
  static constexpr int history = BaseLaw::history;
  static constexpr bool needs_old_F = true;

  BaseLaw law;
  double quadratic = 1.5; ///< Q1
  double linear = 0.06;   ///< Q2
  double density = law.density;

  void start(Lanes* h) const { law.start(h); }
  double reference_wave_speed() const { return law.reference_wave_speed(); }
  ElasticMaterial small_strain() const { return law.small_strain(); }

  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const {
    law.stress(in, h, P, out);
    for (int k = 0; k < num_packs; ++k) {
      const PackTensor F = load(in.F, k), F_old = load(in.F_old, k), cof = cofactor(F);
      const Pack J = determinant(F, cof), J_old = determinant(F_old, cofactor(F_old));
      PackMask inverted;
      std::memcpy(&inverted, reinterpret_cast<const std::int64_t*>(&out.inverted) + k * pack_size, sizeof inverted);
      constexpr double least_J = 1e-3; // below any smallest_J in use: only keeps divisions finite
      const PackMask good = (J > least_J) & (J_old > least_J) & ~inverted;
      const Pack volume = good ? J : pack(1);
      const Pack rate = in.dt > 0 ? min(good ? 2.0 * (J - J_old) / (J + J_old) : Pack{}, 0.0) * (1 / in.dt) : Pack{};
      const Pack sigma_min = volume / sqrt(largest_area_stretch_squared(squares(F), squares(cof), volume));
      const Pack c = sigma_min * sqrt(load(out.wave_speed_squared, k));
      const Pack stretch = cbrt(volume), l = in.length * stretch;
      const Pack per_rate = linear * c - quadratic * l * rate; // q = -ρ l · this · tr D
      const Pack q = -(density * l / volume) * per_rate * rate;
      PackTensor stress = load(P, k);
      for (int i = 0; i < 9; ++i) stress.c[i] -= q * cof.c[i];
      store(P, k, stress);
      store(out.viscous_power, k, load(out.viscous_power, k) - q * rate * volume);
      store(out.damping_ratio, k, load(out.damping_ratio, k) + stretch / sigma_min * (good ? per_rate / c : Pack{}));
    }
  }
};

} // namespace iga::solve
