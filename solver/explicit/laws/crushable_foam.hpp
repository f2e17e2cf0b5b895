// Crushable foam whose principal stresses are cut independently (MODEL 0 of *MAT_CRUSHABLE_FOAM, numerics 7.3).
#pragma once

#include "solver/explicit/laws/curve.hpp"
#include "solver/explicit/laws/inversion.hpp"
#include "solver/explicit/laws/law.hpp"
#include "solver/mechanics/material.hpp"

#include <optional>
#include <string>

namespace iga::solve {

enum class FoamModulus {
  E,         ///< E, also where the curve is steeper
  FinalSlope ///< the last slope of the yield curve replaces E
};

struct FoamSettings {
  double E = 0;             ///< force/length²
  double nu = 0;            ///< elastic; no plastic Poisson effect
  double density = 0;       ///< mass/length³
  Curve yield = {};         ///< Y(γ), force/length², positive, over the volumetric strain γ = 1 - V/V0
  double tension_limit = 0; ///< force/length²; 0: Y(γ) in tension too
  double damping = 0;       ///< share β of σ_visc = β ρ0 c l D, 0 … 1
  FoamModulus modulus = FoamModulus::E;
  InversionPolicy inversion = {.smallest_J = 0.02};
};

/// σ* = Q σ Qᵀ + C : Δε; principal values of σ* cut to -Y(γ) … tension limit; σ = the rest. History: σ (6).
/// Damping β ρ0 c l D with c = √(M/ρ0) and l = h σ_min(F) acts on the forces but is not stored.
class CrushableFoam {
 public:
  static constexpr int history = 6;
  static constexpr bool needs_old_F = true;

  /// @throws InputError for E, nu, density as isotropic(); unless Y > 0 on the whole curve; for a negative tension
  /// limit or damping, and a curve that ends falling (it would cross zero) or gives no modulus
  explicit CrushableFoam(const FoamSettings& settings);

  double density = 1; ///< mass/length³

  void start(Lanes* h) const;
  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
  double reference_wave_speed() const;
  const ElasticMaterial& small_strain() const { return elastic_; }
  /// Where (1 - γ) dY/dγ exceeds the modulus of a plane wave, so that the response of an elastic-plastic column is no
  /// longer exactly -Y(γ) and the time step is that of the curve.
  std::optional<std::string> warning() const;

 private:
  ElasticMaterial elastic_;
  double lambda_, mu_;
  Curve yield_;
  double tension_limit_, damping_;
  InversionPolicy inversion_;
};

} // namespace iga::solve
