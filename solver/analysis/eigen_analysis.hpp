// Vibration modes of a trimmed model, or its largest eigenfrequency, from the prepared settings of a run.
#pragma once

#include "solver/analysis/eigen_solver.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/mechanics/element_bound.hpp"
#include "solver/ties/tie.hpp"

namespace iga::solve {

/// What `igasolve eigen` reports; omega in radians per time, frequencies are omega / 2π.
struct EigenOutcome {
  BodySystem system; ///< the modes' coefficients belong to its spaces; lives no longer than the models
  std::shared_ptr<const SolutionSpace> space; ///< of the first body
  ModeSet modes;                              ///< empty under `largest`
  double omega_max = 0;                       ///< under `largest`: converged to 1e-8, no factor
  double omega_max_residual = 0;
  std::optional<ElementBound> element; ///< under `largest`
  std::int64_t bodies = 0;
  double mass = 0; ///< total, as discretised
  std::int64_t unknowns = 0, constraints = 0;
  std::vector<RegionReport> regions; ///< of the supports
  std::vector<TieReport> ties;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// @param models  placed, one for each body of the run
/// @throws InputError, NumericalError as its parts do
EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings, std::span<const TrimmedModel> models);
inline EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings, const TrimmedModel& model) {
  return analyse_modes(run, settings, {&model, 1});
}

} // namespace iga::solve
