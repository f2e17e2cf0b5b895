// Statics without a factorisation: conjugate gradients with one multigrid cycle a step.
#pragma once

#include "solver/linalg/linear_solver.hpp"
#include "solver/multigrid/multigrid.hpp"

namespace iga::io {
class Progress;
}

namespace iga::solve {

class MultigridSolver final : public LinearSolver {
 public:
  /// @param A  positive definite; what it points to must outlive the solver. Parts of low rank are in the products, not
  ///           in the cycle: they cost a step or two for each of their rows
  /// @param progress  where steps show themselves; may be null
  /// @throws InputError as Multigrid
  MultigridSolver(const ShiftedStiffness& A, const BodySystem& system, io::Progress* progress = nullptr,
                  const MultigridSettings& settings = {}, std::span<const std::vector<std::int64_t>> held = {});

  using LinearSolver::solve;
  /// ‖b - A x‖ ≤ tolerance ‖b‖ column by column, or what rounding leaves of it.
  /// @throws NumericalError where that is not reached in most_steps
  void solve(const double* b, double* x, int columns) const override;
  std::int64_t size() const override { return multigrid_.size(); }
  /// Bytes of the hierarchy; it has no factor.
  FactorCost cost() const override { return {0, 0, multigrid_.bytes()}; }

  const Multigrid& multigrid() const { return multigrid_; }
  int steps() const { return steps_; } ///< of the longest of all solutions so far

  static constexpr double tolerance = 1e-6; ///< static runs refine once more: 1e-12
  static constexpr int most_steps = 500;

 private:
  int conjugate_gradients(const Eigen::VectorXd& b, Eigen::Ref<Eigen::VectorXd> x) const;

  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  ShiftedStiffness A_;
  Multigrid multigrid_;
  io::Progress* progress_;
  mutable int steps_ = 0;
};

} // namespace iga::solve
