// Factorised symmetric systems: CHOLMOD's supernodal Cholesky where the matrix is positive definite, MUMPS where it is
// not or where its inertia is wanted.
#pragma once

#include "solver/linalg/symmetric_matrix.hpp"

#include <functional>

namespace iga::solve {

using ConstraintMatrix = RowMatrix; ///< (constraints × unknowns)

/// What a factorisation costs, known from the symbolic analysis before any number is touched.
struct FactorCost {
  std::int64_t nonzeros = 0; ///< of the factor
  double flops = 0;
  double bytes = 0; ///< peak memory of factor and work space
};

/// A = stiffness - shift · mass, bordered by constraints: [A Cᵀ; C 0]. Pointers may be null but for the stiffness; the
/// mass is either consistent or lumped (num_nodes). What matrices have beside their pattern (add_low_rank) is part of
/// A.
struct SystemMatrix {
  const StiffnessMatrix* stiffness = nullptr;
  const MassMatrix* mass = nullptr;
  const Eigen::VectorXd* lumped_mass = nullptr;
  double shift = 0;
  double added = 0; ///< to the unit diagonal of the scaled matrix (LinearSolver::added_to_diagonal)
  const ConstraintMatrix* constraints = nullptr;
  std::function<void(const FactorCost&)> announce = {}; ///< called with the cost before the factorisation; may be empty
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  /// Solves for `columns` right-hand sides stored one after the other; size: unknowns, then constraints.
  virtual void solve(const double* b, double* x, int columns) const = 0;
  virtual std::int64_t size() const = 0;
  virtual FactorCost cost() const = 0;
  /// What was added to the unit diagonal of the scaled system to factorise it: 0 unless rounding left it indefinite.
  /// A factor with something added is that of a neighbouring system; refine what it solves.
  virtual double added_to_diagonal() const { return 0; }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const {
    Eigen::VectorXd x(b.size());
    solve(b.data(), x.data(), 1);
    return x;
  }
};

/// Cholesky factor of a positive definite system without constraints, scaled by its diagonal, ordered by nested
/// dissection of the node graph (METIS). With parts of low rank both matrices must be positive definite without them,
/// their weights above 0 and the shift at most 0: holds_without_low_rank.
/// @throws InputError where the factor will not fit into the memory that is free, with the estimate
/// @throws NumericalError where the matrix is not positive definite, naming the likely cause
std::unique_ptr<LinearSolver> factorise_positive_definite(const SystemMatrix& system);

/// Can the system be taken for positive definite without its stiffness' part of low rank? Not where weights are below
/// 0, and not without a mass: what springs between two ends hold may have nothing else that does.
bool holds_without_low_rank(const SystemMatrix& system);

/// Cholesky factor of a consistent mass matrix over the nodes (one component; size: num_nodes), without its part of low
/// rank. Throws as above.
std::unique_ptr<LinearSolver> factorise_mass(const MassMatrix& mass);

/// L D Lᵀ of any system, constraints included; redundant constraints are found and given zero multipliers.
/// Throws as factorise_positive_definite.
std::unique_ptr<LinearSolver> factorise_indefinite(const SystemMatrix& system);

/// Signs of the eigenvalues of a system's matrix (Sylvester's law of inertia).
struct Inertia {
  std::int64_t negative = 0, zero = 0, positive = 0;
};
Inertia inertia(const SystemMatrix& system);

} // namespace iga::solve
