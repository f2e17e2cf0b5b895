// Lowest modes without a factorisation: LOBPCG with a multigrid cycle as preconditioner.
#pragma once

#include "solver/analysis/eigen_solver.hpp"
#include "solver/analysis/solver_choice.hpp"
#include "solver/mechanics/body_system.hpp"

namespace iga::solve {

/// Largest residual of these modes (ModeSet::residual). An eigenvalue is off by about the square of that.
constexpr double multigrid_residual = 1e-7;

/// The rigid modes and `settings.modes` elastic ones. Nothing proves that none is missing: the block holds more vectors
/// than are asked for, and what its Ritz values pass over is unlikely, not impossible.
/// @param held  cells under supports and ties, by body (held_cells)
/// @throws InputError as Multigrid
/// @throws NumericalError where it does not converge, or motions beside the rigid ones have no stiffness
ModeSet multigrid_modes(const EigenProblem& problem, const EigenSettings& settings, const BodySystem& system,
                        std::span<const std::vector<std::int64_t>> held, SolverReport& report);

} // namespace iga::solve
