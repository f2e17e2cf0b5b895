// Metal plasticity: von Mises yield surface, isotropic hardening, rate factor; in rate form (numerics 7.2).
#pragma once

#include "solver/explicit/laws/curve.hpp"
#include "solver/explicit/laws/inversion.hpp"
#include "solver/explicit/laws/law.hpp"
#include "solver/mechanics/material.hpp"

namespace iga::solve {

/// Factor R on the yield stress, of the equivalent plastic strain rate ε̇.
struct RateFactor {
  enum class Kind {
    None,          ///< R = 1
    CowperSymonds, ///< R = 1 + (ε̇ / rate)^(1 / exponent)
    JohnsonCook    ///< R = 1 + exponent · ln max(1, ε̇ / rate)
  };
  Kind kind = Kind::None;
  double rate = 1;     ///< D of Cowper and Symonds, ε̇0 of Johnson and Cook; 1/time
  double exponent = 1; ///< q or C

  double value(double plastic_rate) const;
};

struct J2Settings {
  double E = 0;       ///< force/length²
  double nu = 0;      ///< elastic
  double density = 0; ///< mass/length³
  Curve yield = {};   ///< yield stress, force/length², over the equivalent plastic strain, from 0 on
  RateFactor rate = {};
  InversionPolicy inversion = {};
};

/// Trial stress by Hughes–Winget increments, then the radial return to √(3 J2) = R(Δε/Δt) Y(ε_p + Δε), solved to
/// round-off at the end of the step (viscoplastic for a rate factor: never stiffer than elastic). The pressure is
/// elastic. History: σ (6), ε_p.
class J2Plasticity {
 public:
  static constexpr int history = 7;
  static constexpr int plastic_strain = 6;
  static constexpr bool needs_old_F = true;

  /// @throws InputError for E, nu, density as isotropic(); unless the curve starts at 0, is positive and never falls;
  /// for a rate factor with numbers that are not positive
  explicit J2Plasticity(const J2Settings& settings);

  double density = 1; ///< mass/length³

  void start(Lanes* h) const;
  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
  double reference_wave_speed() const;
  const ElasticMaterial& small_strain() const { return elastic_; }

 private:
  Pack plastic_increment(const Pack& equivalent, const Pack& strain, double dt) const;
  Pack cowper_symonds(const Pack& equivalent, const Pack& strain, double dt) const;
  Pack johnson_cook(const Pack& equivalent, const Pack& strain, const Pack& without_rate, double dt) const;

  ElasticMaterial elastic_;
  double lambda_, mu_;
  Curve yield_;
  RateFactor rate_;
  InversionPolicy inversion_;
};

/// @throws InputError, opened by `name`, unless the curve of yield stresses over plastic strain starts at 0, is
/// positive and never falls
void check_hardening(const Curve& yield, const std::string& name);

} // namespace iga::solve
