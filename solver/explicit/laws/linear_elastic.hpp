// Linear elasticity of small strains.
#pragma once

#include "solver/explicit/laws/law.hpp"
#include "solver/mechanics/material.hpp"

namespace iga::solve {

/// P = C : sym(F - I). No geometry: neither objective nor aware of J (no point counts as inverted).
class LinearElastic {
 public:
  static constexpr int history = 0;
  static constexpr bool needs_old_F = false;

  /// @param material isotropic or not; see isotropic() and anisotropic()
  explicit LinearElastic(const ElasticMaterial& material);

  double density = 1; ///< mass/length³

  void start(Lanes*) const {}
  void stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const;
  double reference_wave_speed() const { return wave_speed_; }
  const ElasticMaterial& small_strain() const { return material_; }

 private:
  ElasticMaterial material_;
  double wave_speed_;
};

} // namespace iga::solve
