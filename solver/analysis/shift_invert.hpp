// The operator (K - σ M)⁻¹ of a shift σ < 0, whatever the mass and the constraints.
#pragma once

#include "solver/analysis/eigen_solver.hpp"
#include "solver/linalg/constrained_solver.hpp"

namespace iga::solve {

class ShiftInvert {
 public:
  /// Factorises K - σ M: by Cholesky, or by MUMPS where there are constraints. A multi-pass mass is no matrix; there
  /// K - σ M_L is factorised and serves as preconditioner: as M_L / passes ≤ M ≤ M_L for the plain basis, conjugate
  /// gradients gain a factor of four and more with each step.
  ShiftInvert(const EigenProblem& problem, double shift);

  /// X = (K - σ M)⁻¹ F, (size × columns) column by column; with constraints the X that obeys them.
  void apply(const double* F, double* X, int columns) const;
  /// The same to the rounding of products with K and M: what the factorisation of a nearly singular system loses, or
  /// what was added to its diagonal, is won back by refinement.
  void apply_refined(const double* F, double* X, int columns) const;
  /// Cᵀ μ: the forces of the constraints that balance f, where they can; nothing else is left of the reactions to an
  /// eigenpair's K x - ω² M x. Zero without constraints.
  Eigen::VectorXd constraint_forces(const Eigen::VectorXd& f) const { return factor_->constraint_forces(f); }
  FactorCost cost() const { return factor_->cost(); }
  /// LinearSolver::added_to_diagonal: above 0 where rounding left the shifted system indefinite.
  double added_to_diagonal() const { return factor_->added_to_diagonal(); }

 private:
  void refine(const double* F, double* X, int columns) const;
  void conjugate_gradients(const double* f, double* x) const;

  const EigenProblem& problem_;
  double shift_;
  std::unique_ptr<ConstrainedSolver> factor_;
};

} // namespace iga::solve
