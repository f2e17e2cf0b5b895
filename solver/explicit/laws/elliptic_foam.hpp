// Foam with an elliptic yield surface in mean and deviatoric stress (Deshpande and Fleck 2000,
// doi 10.1016/S0022-5096(99)00082-4; MODEL 1 of *MAT_CRUSHABLE_FOAM is of this kind), numerics 7.4.
#pragma once

#include "solver/explicit/laws/curve.hpp"
#include "solver/explicit/laws/inversion.hpp"
#include "solver/explicit/laws/law.hpp"
#include "solver/mechanics/material.hpp"

#include <variant>

namespace iga::solve {

/// σ_y(ε) = plateau + linear ε/ε_D + log ln(1 / (1 - (ε/ε_D)^power)): Reyes, Hopperstad, Berstad, Hanssen and Langseth
/// 2003. From 99.9 % of ε_D on it goes on as its tangent.
struct DensificationHardening {
  double plateau = 0;              ///< force/length²
  double linear = 0;               ///< force/length²
  double log = 0;                  ///< force/length²
  double power = 1;                ///< β
  double densification_strain = 1; ///< ε_D

  /// σ_y and its slope at ε ≥ 0.
  void evaluate(const Pack& strain, Pack& stress, Pack& slope) const;
};

struct EllipticFoamSettings {
  double E = 0;          ///< force/length²
  double nu = 0;         ///< elastic
  double density = 0;    ///< mass/length³
  double plastic_nu = 0; ///< ratio of plastic strains in uniaxial compression, -1 … 0.5
  /// Yield stress over the equivalent plastic strain ε^ (that of uniaxial compression).
  std::variant<Curve, DensificationHardening> yield = {};
  InversionPolicy inversion = {.smallest_J = 0.02};
};

/// σ^² = (q² + α² p²) / (1 + (α/3)²) ≤ σ_y(ε^)², α² = 9/2 (1 - 2 ν_p) / (1 + ν_p), associated flow, returned at the end
/// of the step to round-off. q = √(3 J2), p the mean stress. History: σ (6), ε^.
class EllipticFoam {
 public:
  static constexpr int history = 7;
  static constexpr int plastic_strain = 6;
  static constexpr bool needs_old_F = true;

  /// @throws InputError for E, nu, density as isotropic(), plastic_nu outside its range, a curve as check_hardening(),
  /// hardening constants that are negative, a plateau, power or ε_D that is not positive
  explicit EllipticFoam(const EllipticFoamSettings& settings);

  double density = 1; ///< mass/length³

  void start(Lanes* h) const;
  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
  double reference_wave_speed() const;
  const ElasticMaterial& small_strain() const { return elastic_; }

 private:
  template <class Yield>
  void stress_with(const Yield& yield, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;

  ElasticMaterial elastic_;
  double lambda_, mu_, alpha_squared_;
  std::variant<Curve, DensificationHardening> yield_;
  InversionPolicy inversion_;
};

} // namespace iga::solve
