#include "solver/linalg/constrained_solver.hpp"

namespace iga::solve {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ConstrainedSolver::ConstrainedSolver(const SystemMatrix& system)
    : unknowns_(system.stiffness->size()),
      constraints_(system.constraints && system.constraints->rows() > 0 ? system.constraints : nullptr) {
  SystemMatrix without = system;
  without.constraints = constraints_;
  const bool definite = !constraints_ && holds_without_low_rank(without);
  factor_ = definite ? factorise_positive_definite(without) : factorise_indefinite(without);
}

void ConstrainedSolver::solve(const double* F, double* X, int columns) const {
  if (!constraints_) {
    factor_->solve(F, X, columns);
    return;
  }
  bordered_ = MatrixXd::Zero(factor_->size(), columns);
  solution_.resize(factor_->size(), columns);
  bordered_.topRows(unknowns_) = Map<const MatrixXd>(F, unknowns_, columns);
  factor_->solve(bordered_.data(), solution_.data(), columns);
  Map<MatrixXd>(X, unknowns_, columns) = solution_.topRows(unknowns_);
}

VectorXd ConstrainedSolver::constraint_forces(const VectorXd& f) const {
  if (!constraints_) return VectorXd::Zero(f.size());
  VectorXd x(f.size());
  solve(f.data(), x.data(), 1);
  return constraints_->transpose() * solution_.col(0).tail(constraints_->rows());
}

} // namespace iga::solve
