#include "solver/analysis/eigen_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "solver/mechanics/rigid_modes.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

EigenOutcome find_modes(const RunSettings& run, const EigenSettings& settings, const TrimmedModel& model) {
  if (settings.largest) refuse_multipliers(run);
  PreparedSystem system = prepare_system(run, model);
  EigenOutcome outcome;
  outcome.timings = std::move(system.timings);
  outcome.warnings = std::move(system.warnings);
  outcome.regions = std::move(system.supports.regions);
  outcome.mass = system.M.total();
  outcome.unknowns = system.space->num_unknowns();
  outcome.constraints = system.supports.constraints.rows();
  const Bodies bodies = separate_bodies(system.K.pattern());
  outcome.bodies = bodies.count;
  if (settings.largest) {
    Stopwatch watch(outcome.timings);
    show_stage(run.progress, "iterations");
    const LargestEigenvalue largest = largest_eigenvalue(system.K, system.M, 1e-8);
    outcome.omega_max = largest.omega;
    outcome.omega_max_residual = largest.residual;
    watch.stage("Lanczos");
    if (run.supports.empty()) outcome.element = element_bound(*system.space, run.material, run.mass);
    watch.stage("element bound");
  } else {
    EigenProblem problem;
    problem.stiffness = &system.K;
    problem.progress = run.progress;
    problem.mass = &system.M;
    problem.constraints = outcome.constraints > 0 ? &system.supports.constraints : nullptr;
    problem.motions = rigid_motions(*system.space, bodies);
    problem.lambda_scale = lambda_scale(*system.space, run.material);
    outcome.modes = lowest_modes(problem, settings);
    outcome.timings.insert(outcome.timings.end(), outcome.modes.timings.begin(), outcome.modes.timings.end());
    outcome.warnings.insert(outcome.warnings.end(), outcome.modes.warnings.begin(), outcome.modes.warnings.end());
  }
  outcome.space = std::move(system.space);
  return outcome;
}

} // namespace

EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings, const TrimmedModel& model) {
  try {
    return find_modes(run, settings, model);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run, model)));
  }
}

} // namespace iga::solve
