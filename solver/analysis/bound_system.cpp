#include "solver/analysis/bound_system.hpp"

#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/supports/body_choice.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

// Terms of the bodies, one after the other, as those of the whole system.
void join_terms(const BodySystem& system, BoundSystem& bound) {
  Eigen::Index rows = 0;
  for (const SupportTerms& terms : bound.of_body) rows += terms.values.size();
  std::vector<Eigen::Triplet<double>> entries;
  bound.load.resize(system.num_unknowns());
  bound.values.resize(rows);
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SupportTerms& terms = bound.of_body[b];
    system.part(bound.load, b) = terms.load;
    bound.values.segment(first, terms.values.size()) = terms.values;
    for (Eigen::Index row = 0; row < terms.constraints.rows(); ++row)
      for (ConstraintMatrix::InnerIterator it(terms.constraints, row); it; ++it)
        entries.emplace_back(static_cast<int>(first + row), static_cast<int>(system[b].first_unknown() + it.col()),
                             it.value());
    first += terms.values.size();
  }
  bound.constraints.resize(rows, system.num_unknowns());
  bound.constraints.setFromTriplets(entries.begin(), entries.end());
}

std::vector<std::vector<Support>> sorted_by_body(const BodySystem& system, const RunSettings& run, BoundSystem& bound) {
  std::vector<std::vector<Support>> of_body(system.size());
  for (const Support& support : run.supports) {
    const std::string what = fmt::format("support '{}'", support.name);
    const std::size_t b = chosen_body(system, support.body, what, [&](std::size_t body) {
      const TrimmedModel& model = system[body].space->model();
      if (support.place.given())
        choose_places(model, support.place, what);
      else
        choose_polygons(model, support.region, what);
    });
    bound.support_body.push_back(b);
    of_body[b].push_back(support);
  }
  return of_body;
}

} // namespace

BoundSystem bind_system(const BodySystem& system, const RunSettings& run, Stopwatch& watch) {
  BoundSystem bound;
  const auto supports = sorted_by_body(system, run, bound);
  std::vector<TieSurface> surfaces = find_ties(system, run.ties);
  if (!run.ties.empty()) watch.stage("ties");
  for (const TieSurface& surface : surfaces) bound.tie_reports.push_back(surface.report);
  show_stage(run.progress, "assembly");
  const auto connectivity = system.connectivity(coupled_nodes(system, surfaces));
  bound.K = assemble_stiffness(system, connectivity);
  watch.stage("stiffness");
  show_stage(run.progress, "supports");
  bound.ties = prepare_ties(system, std::move(surfaces));
  for (std::size_t b = 0; b < system.size(); ++b)
    bound.of_body.push_back(apply_supports(*system[b].space, system[b].material, supports[b], bound.K,
                                           nitsche_sides(bound.ties, b), system[b].first_node));
  join_terms(system, bound);
  std::vector<std::size_t> next(system.size());
  for (const std::size_t b : bound.support_body) {
    bound.regions.push_back(bound.of_body[b].regions[next[b]++]);
    bound.regions.back().body = system.name_among_several(b);
  }
  bound.springs = prepare_springs(system, run.springs);
  add_springs(system, bound.springs, bound.K);
  bound.masses = prepare_masses(system, run.masses);
  std::vector<RigidRegions::Held> held;
  for (const PreparedMass& mass : bound.masses)
    if (mass.added.holds_region) held.push_back({mass.body, mass.region});
  bound.rigid_masses = RigidRegions(system, std::move(held), bound.K);
  bound.rigid_masses.complete(bound.K);
  if (!run.supports.empty() || !run.springs.empty()) watch.stage("supports");
  add_ties(system, bound.ties, bound.K);
  if (!run.ties.empty()) watch.stage("ties");
  return bound;
}

AttachedParts attached_parts(const BoundSystem& bound) {
  AttachedParts parts;
  parts.triangles.resize(bound.of_body.size());
  const auto take = [&](std::size_t body, const SurfaceRegion& region) {
    auto& all = parts.triangles[body];
    all.insert(all.end(), region.triangles.begin(), region.triangles.end());
  };
  for (const PreparedSpring& spring : bound.springs) {
    take(spring.body, spring.region);
    if (spring.spring.to) take(spring.other_body, spring.other);
  }
  for (const PreparedMass& mass : bound.masses) take(mass.body, mass.region);
  for (const PreparedSpring& spring : bound.springs)
    parts.springs.push_back({spring.region.report, spring.spring, spring.other.report.centroid});
  for (const PreparedMass& mass : bound.masses) parts.masses.push_back({mass.region.report, mass.added, mass.centre});
  return parts;
}

std::vector<std::string> attached_warnings(const AttachedParts& parts) {
  std::vector<std::string> all;
  const auto take = [&](const RegionReport& region, const char* kind) {
    for (const std::string& warning : region_warnings(region, fmt::format("{} '{}'", kind, region.name)))
      all.push_back(warning);
  };
  for (const auto& spring : parts.springs) take(spring.region, "spring");
  for (const auto& mass : parts.masses) take(mass.region, "added mass");
  return all;
}

std::vector<Reaction> reactions(const BodySystem& system, const BoundSystem& bound, const Eigen::VectorXd& u,
                                const Eigen::VectorXd& multipliers) {
  std::vector<std::vector<Reaction>> of_body;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SupportTerms& terms = bound.of_body[b];
    of_body.push_back(reactions(*system[b].space, system[b].material, terms, system.part(u, b),
                                multipliers.segment(first, terms.values.size())));
    first += terms.values.size();
  }
  std::vector<Reaction> all;
  std::vector<std::size_t> next(system.size());
  for (const std::size_t b : bound.support_body) all.push_back(of_body[b][next[b]++]);
  return all;
}

} // namespace iga::solve
