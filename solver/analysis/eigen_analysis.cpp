#include "solver/analysis/eigen_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/field_errors.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "solver/mechanics/rigid_modes.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

// Why errors of modes cannot be estimated; empty where they can.
std::string no_errors(const RunSettings& run, const BodySystem& system) {
  if (run.mass != MassType::Consistent) return "the estimate is that of the consistent mass";
  return no_field_errors(system);
}

void estimate_errors(const RunSettings& run, const EigenSettings& settings, const BoundSystem& bound,
                     EigenOutcome& outcome) {
  if (!settings.errors.value_or(true)) return;
  if (const std::string reason = no_errors(run, outcome.system); !reason.empty()) {
    if (settings.errors) outcome.warnings.push_back("errors of the modes are not estimated: " + reason);
    return;
  }
  Stopwatch watch(outcome.timings);
  show_stage(run.progress, "errors");
  const ModeSet& modes = outcome.modes;
  const Eigen::Index first = modes.vectors.cols() - modes.elastic;
  outcome.lambda_error = Eigen::VectorXd::Zero(modes.vectors.cols());
  outcome.lambda_error->tail(modes.elastic) = total_errors(field_errors(
      outcome.system, bound, modes.vectors.rightCols(modes.elastic), modes.lambda.segment(first, modes.elastic)));
  watch.stage("errors");
}

EigenOutcome find_modes(const RunSettings& run, const EigenSettings& settings, std::span<const TrimmedModel> models) {
  if (settings.largest) refuse_multipliers(run);
  PreparedSystem system = prepare_system(run, models);
  EigenOutcome outcome;
  hand_over(system, outcome);
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
    if (run.supports.empty() && run.ties.empty()) outcome.element = element_bound(outcome.system, run.mass);
    watch.stage("element bound");
  } else {
    EigenProblem problem;
    problem.stiffness = &K;
    problem.progress = run.progress;
    problem.mass = &system.M;
    problem.constraints = outcome.constraints > 0 ? &system.bound.constraints : nullptr;
    problem.motions = rigid_motions(outcome.system, bodies);
    problem.lambda_scale = lambda_scale(outcome.system);
    outcome.modes = lowest_modes(problem, settings);
    outcome.timings.insert(outcome.timings.end(), outcome.modes.timings.begin(), outcome.modes.timings.end());
    outcome.warnings.insert(outcome.warnings.end(), outcome.modes.warnings.begin(), outcome.modes.warnings.end());
    outcome.participation = participation(outcome.system, system.M, outcome.modes.vectors);
    estimate_errors(run, settings, system.bound, outcome);
  }
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
