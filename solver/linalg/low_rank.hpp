// Systems with a part of low rank, A + Rᵀ R: what few motions of many unknowns add (a rigid body on a surface).
#pragma once

#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

/// Rows that a system has beside its pattern, with their weights: Σ weight_k r_kᵀ r_k is added to the matrix.
struct LowRankRows {
  RowMatrix rows;          ///< (rank × unknowns)
  Eigen::VectorXd weights; ///< (rank): those of the stiffness, -shift of the mass
};
LowRankRows low_rank_rows(const SystemMatrix& system);

/// Solves (A + Rᵀ R) x = b by a solver of A (Sherman, Morrison & Woodbury 1950).
/// @param rows  (rank × unknowns): R
/// @throws InputError where A⁻¹ Rᵀ does not fit into the memory that is free
std::unique_ptr<LinearSolver> with_low_rank(std::unique_ptr<LinearSolver> plain, const RowMatrix& rows);

} // namespace iga::solve
