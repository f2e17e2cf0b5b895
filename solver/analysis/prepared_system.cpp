#include "solver/analysis/prepared_system.hpp"

#include "format/model/errors.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/assemble.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace iga::solve {

void refuse_multipliers(const RunSettings& run) {
  if (std::any_of(run.supports.begin(), run.supports.end(),
                  [](const Support& s) { return s.method == SupportMethod::Lagrange; }))
    throw InputError("the time step is that of explicit dynamics, which knows no Lagrange multipliers; use "
                     "method = \"penalty\" or \"nitsche\" in the supports");
}

void hand_over(PreparedSystem& prepared, SystemOutcome& outcome) {
  outcome.system = std::move(prepared.bodies);
  outcome.mass = prepared.M.total();
  outcome.unknowns = outcome.system.num_unknowns();
  outcome.regions = std::move(prepared.bound.regions);
  outcome.ties = std::move(prepared.bound.tie_reports);
  outcome.attached = attached_parts(prepared.bound);
  outcome.warnings = std::move(prepared.warnings);
  outcome.timings = std::move(prepared.timings);
}

BodySystem make_system(const RunSettings& run, std::span<const TrimmedModel> models) {
  const std::vector<RunBody> bodies = bodies_of(run);
  BodySystem system;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    system.add(bodies[b].file.name, std::make_shared<const SolutionSpace>(models[b], bodies[b].light),
               bodies[b].material);
  return system;
}

std::vector<std::string> space_warnings(const BodySystem& system) {
  std::vector<std::string> all;
  for (std::size_t b = 0; b < system.size(); ++b)
    for (const std::string& warning : system[b].space->warnings()) all.push_back(system.prefix(b) + warning);
  return all;
}

PreparedSystem prepare_system(const RunSettings& run, std::span<const TrimmedModel> models) {
  PreparedSystem system;
  Stopwatch watch(system.timings);
  show_stage(run.progress, "assembly");
  system.bodies = make_system(run, models);
  watch.stage("space");
  system.bound = bind_system(system.bodies, run, watch);
  system.M = make_mass(run.mass, system.bodies, system.bound.K.shared_connectivity(), system.bound.masses);
  watch.stage("mass");
  system.warnings = space_warnings(system.bodies);
  if (system.M.moved_functions() > 0)
    system.warnings.push_back(fmt::format("the lumped mass of {} light functions went to their nearest neighbours: "
                                          "extrapolation would have left others without mass",
                                          system.M.moved_functions()));
  for (const std::vector<std::string>& more :
       {region_warnings(system.bound.regions), attached_warnings(attached_parts(system.bound))})
    system.warnings.insert(system.warnings.end(), more.begin(), more.end());
  return system;
}

} // namespace iga::solve
