// A factorised system seen from its unknowns: constraints are obeyed, their multipliers stay inside.
#pragma once

#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

class ConstrainedSolver {
 public:
  /// Factorises the system: by Cholesky, or by MUMPS where there are constraints or a part of low rank asks for it.
  /// Throws as they do.
  explicit ConstrainedSolver(const SystemMatrix& system);

  /// X: of A X = F, (unknowns × columns) column by column; with constraints the X that obeys them.
  void solve(const double* F, double* X, int columns) const;
  /// Cᵀ μ: the forces of the constraints that balance f, where they can. Zero without constraints.
  Eigen::VectorXd constraint_forces(const Eigen::VectorXd& f) const;
  FactorCost cost() const { return factor_->cost(); }
  double added_to_diagonal() const { return factor_->added_to_diagonal(); } ///< as of LinearSolver

 private:
  std::int64_t unknowns_;
  const ConstraintMatrix* constraints_; // null: none
  std::unique_ptr<LinearSolver> factor_;
  mutable Eigen::MatrixXd bordered_, solution_;
};

} // namespace iga::solve
