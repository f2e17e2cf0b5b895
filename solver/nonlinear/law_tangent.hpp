// Stress of eight points and its derivative with respect to the deformation gradient, by the laws of explicit runs.
#pragma once

#include "solver/explicit/laws/law_access.hpp"
#include "solver/explicit/laws/laws.hpp"

namespace iga::solve {

/// A_{aAbB} = ∂P_aA/∂F_bB of eight points: component 9 (3 a + A) + 3 b + B. force/length²
struct TangentLanes {
  std::array<Lanes, 81> c;
};

/// A law as statics use it: from the state of the last converged step (history, F_old) straight to F, without rates
/// (dt = 0).
class StaticLaw {
 public:
  /// @param length  smallest side of a span
  StaticLaw(const Law& law, double length);

  int history() const { return access_.history; }
  bool needs_old_F() const { return access_.needs_old_F; }
  /// Where the equivalent plastic strain lies in the history, -1 where the law has none.
  int plastic_strain() const { return access_.plastic_strain; }
  void start(Lanes* h) const { access_.start(access_.law.get(), h); }
  /// Is A_{aAbB} = A_{bBaA}? So for laws that have an energy.
  bool is_symmetric() const { return form_ != Form::Differences; }

  /// @param F_old  of the last converged step; read where needs_old_F
  /// @param h      moves on to F
  /// @return points that lie below the law's min_volume_ratio, as lanes
  LaneMask stress(const TensorLanes& F, const TensorLanes& F_old, Lanes* h, TensorLanes& P, Lanes& J) const;

  /// In closed form for linear elasticity, St. Venant–Kirchhoff and neo-Hookean; for the others, whose history the step
  /// changes, central differences of the whole update (18 evaluations): the algorithmic tangent, to about ten digits.
  /// @param h  stays as it is
  void tangent(const TensorLanes& F, const TensorLanes& F_old, const Lanes* h, TangentLanes& A) const;

 private:
  enum class Form { Linear, StVenantKirchhoff, NeoHookean, Differences };
  void differences(const TensorLanes& F, const TensorLanes& F_old, const Lanes* h, TangentLanes& A) const;

  LawAccess access_;
  double length_;
  Form form_ = Form::Differences;
  double lambda_ = 0, mu_ = 0;
  std::array<double, 81> linear_{};
};

} // namespace iga::solve
