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

EigenOutcome find_modes(const RunSettings& run, const EigenSettings& settings, std::span<const TrimmedModel> models) {
  if (settings.largest) refuse_multipliers(run);
  PreparedSystem system = prepare_system(run, models);
  EigenOutcome outcome;
  outcome.timings = std::move(system.timings);
  outcome.warnings = std::move(system.warnings);
  outcome.regions = std::move(system.bound.regions);
  outcome.ties = std::move(system.bound.tie_reports);
  outcome.mass = system.M.total();
  outcome.unknowns = system.bodies.num_unknowns();
  outcome.constraints = system.bound.constraints.rows();
  const StiffnessMatrix& K = system.bound.K;
  const Bodies bodies = separate_bodies(K.pattern());
  outcome.bodies = bodies.count;
  if (settings.largest) {
    Stopwatch watch(outcome.timings);
    show_stage(run.progress, "iterations");
    const LargestEigenvalue largest = largest_eigenvalue(K, system.M, 1e-8);
    outcome.omega_max = largest.omega;
    outcome.omega_max_residual = largest.residual;
    watch.stage("Lanczos");
    if (run.supports.empty() && run.ties.empty()) outcome.element = element_bound(system.bodies, run.mass);
    watch.stage("element bound");
  } else {
    EigenProblem problem;
    problem.stiffness = &K;
    problem.progress = run.progress;
    problem.mass = &system.M;
    problem.constraints = outcome.constraints > 0 ? &system.bound.constraints : nullptr;
    problem.motions = rigid_motions(system.bodies, bodies);
    problem.lambda_scale = lambda_scale(system.bodies);
    outcome.modes = lowest_modes(problem, settings);
    outcome.timings.insert(outcome.timings.end(), outcome.modes.timings.begin(), outcome.modes.timings.end());
    outcome.warnings.insert(outcome.warnings.end(), outcome.modes.warnings.begin(), outcome.modes.warnings.end());
  }
  outcome.system = std::move(system.bodies);
  outcome.space = outcome.system[0].space;
  return outcome;
}

} // namespace

EigenOutcome analyse_modes(const RunSettings& run, const EigenSettings& settings,
                           std::span<const TrimmedModel> models) {
  try {
    return find_modes(run, settings, models);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run, models)));
  }
}

} // namespace iga::solve
