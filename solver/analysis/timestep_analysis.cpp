#include "solver/analysis/timestep_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double lanczos_tolerance = 1e-3;

TimestepOutcome find_timestep(const RunSettings& run, std::span<const TrimmedModel> models) {
  PreparedSystem system = prepare_system(run, models);
  TimestepOutcome outcome;
  hand_over(system, outcome);
  Stopwatch watch(outcome.timings);
  show_stage(run.progress, "iterations");
  const LargestEigenvalue largest = largest_eigenvalue(system.bound.K, system.M, lanczos_tolerance);
  outcome.omega_max = largest.omega;
  outcome.products = largest.products;
  outcome.omega_max_bound = omega_safety * largest.omega;
  outcome.dt_crit = 2 / outcome.omega_max;
  outcome.dt_safe = 2 / outcome.omega_max_bound;
  watch.stage("Lanczos");
  // Supports, springs and ties add stiffness that no span's own matrix knows of.
  if (run.supports.empty() && run.springs.empty() && run.ties.empty())
    outcome.element = element_bound(outcome.system, run.mass);
  if (outcome.element) outcome.dt_element = 2 / outcome.element->omega;
  watch.stage("element bound");
  return outcome;
}

} // namespace

TimestepOutcome analyse_timestep(const RunSettings& run, std::span<const TrimmedModel> models) {
  refuse_multipliers(run);
  try {
    return find_timestep(run, models);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run, models)));
  }
}

} // namespace iga::solve
