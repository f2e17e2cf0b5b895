#include "solver/analysis/eigen_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/buckling_analysis.hpp"
#include "solver/analysis/field_errors.hpp"
#include "solver/analysis/multigrid_modes.hpp"
#include "solver/analysis/static_solver.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "solver/mechanics/rigid_modes.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

// Why errors of modes cannot be estimated; empty where they can.
std::string no_errors(const RunSettings& run, const EigenSettings& settings, const BodySystem& system) {
  if (run.mass != MassType::Consistent) return "the estimate is that of the consistent mass";
  if (settings.prestress) return "the estimate knows no prestress";
  return no_field_errors(system);
}

void estimate_errors(const RunSettings& run, const EigenSettings& settings, const BoundSystem& bound,
                     EigenOutcome& outcome) {
  if (!settings.errors.value_or(true)) return;
  if (const std::string reason = no_errors(run, settings, outcome.system); !reason.empty()) {
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

// Adds the preload's stiffness to the system's.
void preload_system(const RunSettings& run, PreparedSystem& system, EigenOutcome& outcome) {
  const StaticSettings& statics = run.statics;
  if (statics.loads.empty() && statics.bolts.empty() && !statics.temperature)
    throw InputError("prestress: the run has no loads; add a [[load]] to the run file, or leave prestress out");
  Stopwatch watch(system.timings);
  outcome.preload = make_preload(run, all_of(statics), system.bodies, system.bound);
  add_scaled(outcome.preload->stiffness, 1, system.bound.K);
  const std::vector<std::string>& warnings = outcome.preload->warnings;
  system.warnings.insert(system.warnings.end(), warnings.begin(), warnings.end());
  watch.stage("preload");
}

// Why K + L has motions without stiffness: the factor on the loads at which the part buckles, where it is below 1.
void say_if_buckled(StiffnessMatrix& K, const ConstraintMatrix* constraints, const Preload& preload,
                    io::Progress* progress) {
  add_scaled(preload.stiffness, -1, K);
  const std::optional<double> factor = first_factor(K, constraints, preload, progress);
  if (factor && *factor <= 1)
    throw InputError(fmt::format("the part buckles under its loads: K + K_G is not positive definite, and modes about "
                                 "that state do not exist. It buckles at {:.4g} times these loads (igasolve buckling "
                                 "shows how); give smaller loads, or hold the part in more places",
                                 *factor));
}

// A preloaded part has no rigid modes: its supports hold it.
ModeSet preloaded_modes(const EigenProblem& problem, const EigenSettings& settings, const Preload& preload,
                        StiffnessMatrix& K) {
  try {
    ModeSet modes = lowest_modes(problem, settings);
    if (modes.lambda.minCoeff() > 0) return modes;
  } catch (const NumericalError&) {
    say_if_buckled(K, problem.constraints, preload, problem.progress);
    throw;
  }
  say_if_buckled(K, problem.constraints, preload, problem.progress);
  throw NumericalError("a mode has a negative omega² although the loads stay below the buckling load: rounding");
}

// More modes than this take too many vectors at a time.
constexpr int most_multigrid_modes = 60;

std::string obstacle_of(const RunSettings& run, const EigenSettings& settings, const EigenProblem& problem) {
  if (problem.constraints)
    return "supports by Lagrange multipliers make the system indefinite, which the multigrid solver cannot treat";
  if (settings.prestress) return "the multigrid solver knows no modes of loaded parts (prestress)";
  if (settings.modes_below) return "the multigrid solver finds a number of modes, not all below a frequency";
  if (settings.modes > most_multigrid_modes)
    return fmt::format("the multigrid solver finds {} modes at most", most_multigrid_modes);
  if (settings.sturm.value_or(false)) return "a Sturm count needs the direct solver's factor";
  if (run.mass == MassType::TwoPass || run.mass == MassType::ThreePass)
    return "the multigrid solver knows consistent and lumped masses alone";
  return "";
}

// By the solver that was asked for; where nobody named one and multigrid fails, by the direct one.
ModeSet modes_by_choice(const RunSettings& run, const EigenSettings& settings, const EigenProblem& problem,
                        const BoundSystem& bound, EigenOutcome& outcome) {
  const bool by_itself = run.solver == SolverKind::Auto;
  std::string obstacle = obstacle_of(run, settings, problem);
  if (obstacle.empty() && by_itself) obstacle = doubt_about(outcome.system);
  outcome.solver = choose_solver(run.solver, problem.stiffness->pattern(), obstacle);
  if (!outcome.solver.multigrid) return lowest_modes(problem, settings);
  const auto give_up = [&](const std::exception& error) {
    outcome.solver.multigrid = false;
    outcome.solver.reason = fmt::format("multigrid was tried: {}", error.what());
  };
  try {
    return multigrid_modes(problem, settings, outcome.system, held_cells(bound), outcome.solver);
  } catch (const InputError& error) {
    if (!by_itself) throw;
    give_up(error);
  } catch (const NumericalError& error) {
    if (!by_itself) throw;
    give_up(error);
  }
  return lowest_modes(problem, settings);
}

EigenOutcome find_modes(const RunSettings& run, const EigenSettings& settings, std::span<const TrimmedModel> models) {
  if (settings.largest) refuse_multipliers(run);
  if (settings.prestress && run.solver == SolverKind::Multigrid)
    throw InputError(
        "solver = \"multigrid\": it knows no modes of loaded parts (prestress); use \"direct\" or \"auto\"");
  if (settings.largest && settings.prestress)
    throw InputError("prestress: the largest eigenfrequency is asked for, which loads hardly change; leave prestress "
                     "or largest out");
  PreparedSystem system = prepare_system(run, models);
  EigenOutcome outcome;
  if (settings.prestress) preload_system(run, system, outcome);
  hand_over(system, outcome);
  outcome.constraints = system.bound.constraints.rows();
  StiffnessMatrix& K = system.bound.K;
  const Bodies bodies = separate_bodies(K.pattern());
  outcome.bodies = bodies.count;
  if (settings.largest) {
    Stopwatch watch(outcome.timings);
    show_stage(run.progress, "iterations");
    const LargestEigenvalue largest = largest_eigenvalue(K, system.M, 1e-8);
    outcome.omega_max = largest.omega;
    outcome.omega_max_residual = largest.residual;
    watch.stage("Lanczos");
    if (run.supports.empty() && run.springs.empty() && run.ties.empty())
      outcome.element = element_bound(outcome.system, run.mass);
    watch.stage("element bound");
  } else {
    EigenProblem problem;
    problem.stiffness = &K;
    problem.progress = run.progress;
    problem.mass = &system.M;
    problem.constraints = outcome.constraints > 0 ? &system.bound.constraints : nullptr;
    problem.motions = outcome.preload ? Eigen::MatrixXd(K.size(), 0) : rigid_motions(outcome.system, bodies);
    problem.lambda_scale = lambda_scale(outcome.system);
    outcome.modes = outcome.preload ? preloaded_modes(problem, settings, *outcome.preload, K)
                                    : modes_by_choice(run, settings, problem, system.bound, outcome);
    if (outcome.preload) outcome.preload->stiffness = {};
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
