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

PreparedSystem prepare_system(const RunSettings& run, const TrimmedModel& model) {
  PreparedSystem system;
  Stopwatch watch(system.timings);
  show_stage(run.progress, "assembly");
  system.space = std::make_unique<SolutionSpace>(model, run.light);
  const auto connectivity = std::make_shared<const Connectivity>(*system.space);
  watch.stage("space");
  system.K = assemble_stiffness(*system.space, connectivity, run.material);
  watch.stage("stiffness");
  system.M = make_mass(run.mass, *system.space, connectivity, run.material.density);
  watch.stage("mass");
  system.warnings = system.space->warnings();
  if (system.M.moved_functions() > 0)
    system.warnings.push_back(fmt::format("the lumped mass of {} light functions went to their nearest neighbours: "
                                          "extrapolation would have left others without mass",
                                          system.M.moved_functions()));
  if (!run.supports.empty()) {
    show_stage(run.progress, "supports");
    system.supports = apply_supports(*system.space, run.material, run.supports, system.K);
    const std::vector<std::string> of_places = region_warnings(system.supports, model.grid);
    system.warnings.insert(system.warnings.end(), of_places.begin(), of_places.end());
    watch.stage("supports");
  }
  return system;
}

} // namespace iga::solve
