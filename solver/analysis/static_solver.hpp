// The solver of a static system, direct or by multigrid, as chosen.
#pragma once

#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/inertia_relief.hpp"
#include "solver/analysis/solver_choice.hpp"
#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

/// Why `auto` leaves multigrid to those who ask for it by name; empty: it does not.
std::string doubt_about(const BodySystem& system);

/// Cells under supports, springs to the ground and ties, by body: multigrid solves for each of them as a whole.
std::vector<std::vector<std::int64_t>> held_cells(const BoundSystem& bound);

/// @param relief         inertia relief, or null
/// @param rigid_regions  loads keep their regions rigid: the system is corrected with what the solver gives
/// @param[out] report    what was taken; lives as long as the solver, which counts its steps there
/// @throws InputError where multigrid is asked for and cannot treat the system
std::unique_ptr<LinearSolver> static_solver(const RunSettings& run, const BodySystem& system, const BoundSystem& bound,
                                            const InertiaRelief* relief, bool rigid_regions, SolverReport& report);

} // namespace iga::solve
