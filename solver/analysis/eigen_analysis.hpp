// Vibration modes of a trimmed model, or its largest eigenfrequency, from the prepared settings of a run.
#pragma once

#include "solver/analysis/eigen_solver.hpp"
#include "solver/analysis/participation.hpp"
#include "solver/analysis/preload.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/analysis/solver_choice.hpp"
#include "solver/mechanics/element_bound.hpp"

namespace iga::solve {

/// What `igasolve eigen` reports; omega in radians per time, frequencies are omega / 2π.
struct EigenOutcome : SystemOutcome {
  ModeSet modes; ///< empty under `largest`
  /// Estimated errors of ω² of the modes (0 of rigid ones); none where they were not asked for or cannot be told.
  std::optional<Eigen::VectorXd> lambda_error;
  Participation participation; ///< of the modes
  double omega_max = 0;        ///< under `largest`: converged to 1e-8, no factor
  double omega_max_residual = 0;
  std::optional<ElementBound> element; ///< under `largest`
  std::optional<Preload> preload;      ///< with prestress: the state that the modes vibrate about
  std::int64_t bodies = 0;             ///< mechanically separate ones
  std::int64_t constraints = 0;
  SolverReport solver; ///< of the modes
};

/// @param models  placed, one for each body of the run
/// @throws InputError, NumericalError as its parts do; InputError where the part buckles under its preload
EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings, std::span<const TrimmedModel> models);
inline EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings, const TrimmedModel& model) {
  return analyse_modes(run, settings, {&model, 1});
}

} // namespace iga::solve
