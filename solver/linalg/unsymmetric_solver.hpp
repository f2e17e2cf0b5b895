// Factorised unsymmetric systems whose sparsity is symmetric: tangents of plasticity, following pressure, friction.
#pragma once

#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

/// L U of A by MUMPS, scaled by the diagonal, ordered by nested dissection of the node graph.
/// @param lower  A on and below the diagonal blocks, the diagonal blocks whole
/// @param upper  the same of Aᵀ; its diagonal blocks are not read
/// Throws as factorise_positive_definite.
std::unique_ptr<LinearSolver> factorise_unsymmetric(const StiffnessMatrix& lower, const StiffnessMatrix& upper);

} // namespace iga::solve
