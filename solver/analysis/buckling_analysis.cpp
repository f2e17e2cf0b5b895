#include "solver/analysis/buckling_analysis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"
#include "solver/mechanics/rigid_modes.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

void add_timings(std::vector<std::pair<std::string, double>>& all,
                 const std::vector<std::pair<std::string, double>>& more) {
  for (const auto& time : more) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const auto& t) { return t.first == time.first; });
    if (known != all.end())
      known->second += time.second;
    else
      all.push_back(time);
  }
}

void add_texts(std::vector<std::string>& all, const std::vector<std::string>& more) {
  for (const std::string& text : more)
    if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
}

double limit_of(const Preload& preload) {
  if (!(preload.largest_strain > 0))
    throw InputError("the loads that grow leave the part without stress, so that it cannot buckle; check their sizes "
                     "and what they act on");
  return largest_buckling_strain / preload.largest_strain;
}

bool prescribes(const Support& support) {
  const auto is_zero = [](const Point3& v) { return v == Point3{}; };
  return !is_zero(support.value) || !std::all_of(support.gradient.begin(), support.gradient.end(), is_zero);
}

void need_loads(const RunSettings& run, const PreloadChoice& growing) {
  const bool prescribed = std::any_of(run.supports.begin(), run.supports.end(), prescribes);
  if (!growing.loads.empty() || !growing.bolts.empty() || run.statics.temperature || prescribed) return;
  throw InputError(run.statics.loads.empty() && run.statics.bolts.empty()
                       ? "a buckling analysis needs loads: add a [[load]] to the run file"
                       : "[buckling] constant names all loads: none is left to grow; leave one of them out");
}

// K + L of constant loads; with constraints an indefinite matrix would go unnoticed.
void need_stable(const BoundSystem& bound, io::Progress* progress) {
  const bool constrained = bound.constraints.rows() > 0;
  SystemMatrix system;
  system.stiffness = &bound.K;
  if (constrained) system.constraints = &bound.constraints;
  show_stage(progress, "stability under the constant loads");
  const Inertia counts = inertia(system);
  const std::int64_t negative = counts.negative - (constrained ? bound.constraints.rows() - counts.zero : 0);
  if (negative > 0)
    throw InputError(fmt::format("the constant loads alone make the part buckle: {} of its motions have lost their "
                                 "stiffness; run buckling with these loads growing to see at which factor",
                                 negative));
}

BucklingOutcome find_factors(const RunSettings& run, const BucklingSettings& settings,
                             std::span<const TrimmedModel> models) {
  const auto choose = [&](bool constant) {
    return PreloadChoice{chosen_by_name(run.statics.loads, settings.constant, constant),
                         chosen_by_name(run.statics.bolts, settings.constant, constant), !constant};
  };
  const PreloadChoice growing = choose(false);
  need_loads(run, growing);
  BucklingOutcome outcome;
  Stopwatch watch(outcome.timings);
  show_stage(run.progress, "assembly");
  outcome.system = make_system(run, models);
  watch.stage("space");
  outcome.unknowns = outcome.system.num_unknowns();
  outcome.warnings = space_warnings(outcome.system);
  BoundSystem bound = bind_system(outcome.system, run, watch);
  outcome.attached = attached_parts(bound);
  outcome.bodies = separate_bodies(bound.K.pattern()).count;
  outcome.constraints = bound.constraints.rows();
  outcome.growing = make_preload(run, growing, outcome.system, bound);
  add_texts(outcome.warnings, outcome.growing.warnings);
  if (!settings.constant.empty()) {
    outcome.constant = make_preload(run, choose(true), outcome.system, bound);
    add_texts(outcome.warnings, outcome.constant->warnings);
    add_scaled(outcome.constant->stiffness, 1, bound.K);
    outcome.constant->stiffness = {};
    need_stable(bound, run.progress);
  }
  watch.stage("preload");
  outcome.limit = limit_of(outcome.growing);
  BucklingProblem problem;
  problem.stiffness = &bound.K;
  problem.load_stiffness = &outcome.growing.stiffness;
  problem.constraints = outcome.constraints > 0 ? &bound.constraints : nullptr;
  problem.progress = run.progress;
  problem.limit = outcome.limit;
  BucklingSolver solver(problem);
  outcome.cost = solver.cost();
  outcome.positive = solver.lowest(settings.factors, LoadSign::Positive, settings.sturm);
  add_texts(outcome.warnings, outcome.positive.warnings);
  if (settings.negative) {
    outcome.negative = solver.lowest(settings.factors, LoadSign::Negative, settings.sturm);
    add_texts(outcome.warnings, outcome.negative->warnings);
  }
  outcome.growing.stiffness = {};
  outcome.regions = std::move(bound.regions);
  outcome.ties = std::move(bound.tie_reports);
  add_timings(outcome.timings, solver.timings);
  return outcome;
}

} // namespace

std::optional<double> first_factor(const StiffnessMatrix& K, const ConstraintMatrix* constraints,
                                   const Preload& preload, io::Progress* progress) {
  BucklingProblem problem;
  problem.stiffness = &K;
  problem.load_stiffness = &preload.stiffness;
  problem.constraints = constraints;
  problem.progress = progress;
  problem.limit = limit_of(preload);
  const BucklingModes modes = BucklingSolver(problem).lowest(1, LoadSign::Positive, false);
  return modes.factor.size() > 0 ? std::optional(modes.factor[0]) : std::nullopt;
}

BucklingOutcome analyse_buckling(const RunSettings& run, const BucklingSettings& settings,
                                 std::span<const TrimmedModel> models) {
  try {
    return find_factors(run, settings, models);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run, models)));
  }
}

} // namespace iga::solve
