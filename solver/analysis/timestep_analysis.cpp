#include "solver/analysis/timestep_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double lanczos_tolerance = 1e-3;

TimestepOutcome find_timestep(const RunSettings& run, const TrimmedModel& model) {
  PreparedSystem system = prepare_system(run, model);
  TimestepOutcome outcome;
  outcome.timings = std::move(system.timings);
  outcome.warnings = std::move(system.warnings);
  outcome.regions = std::move(system.supports.regions);
  outcome.mass = system.M.total();
  outcome.unknowns = system.space->num_unknowns();
  Stopwatch watch(outcome.timings);
  show_stage(run.progress, "iterations");
  const LargestEigenvalue largest = largest_eigenvalue(system.K, system.M, lanczos_tolerance);
  outcome.omega_max = largest.omega;
  outcome.products = largest.products;
  outcome.omega_max_bound = omega_safety * largest.omega;
  outcome.dt_crit = 2 / outcome.omega_max;
  outcome.dt_safe = 2 / outcome.omega_max_bound;
  watch.stage("Lanczos");
  // Supports add stiffness that no span's own matrix knows of.
  if (run.supports.empty()) outcome.element = element_bound(*system.space, run.material, run.mass);
  if (outcome.element) outcome.dt_element = 2 / outcome.element->omega;
  watch.stage("element bound");
  outcome.space = std::move(system.space);
  return outcome;
}

} // namespace

TimestepOutcome analyse_timestep(const RunSettings& run, const TrimmedModel& model) {
  refuse_multipliers(run);
  try {
    return find_timestep(run, model);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run, model)));
  }
}

} // namespace iga::solve
