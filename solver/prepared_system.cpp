#include "solver/prepared_system.hpp"

#include "solver/assemble.hpp"
#include "solver/stopwatch.hpp"

namespace iga::solve {

PreparedSystem prepare_system(const RunSettings& run, const TrimmedModel& model) {
  PreparedSystem system;
  Stopwatch watch(system.timings);
  system.space = std::make_unique<SolutionSpace>(model, run.light);
  const auto connectivity = std::make_shared<const Connectivity>(*system.space);
  watch.stage("space");
  system.K = assemble_stiffness(*system.space, connectivity, run.material);
  watch.stage("stiffness");
  system.M = make_mass(run.mass, *system.space, connectivity, run.material.density);
  watch.stage("mass");
  if (!run.supports.empty()) {
    system.supports = apply_supports(*system.space, run.material, run.supports, system.K);
    watch.stage("supports");
  }
  return system;
}

} // namespace iga::solve
