#include "solver/analysis/system_loads.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/supports/body_choice.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace iga::solve {

namespace {

std::vector<std::size_t> bodies_of_load(const BodySystem& system, const Load& load) {
  const std::string what = fmt::format("load '{}'", load.name);
  if (acts_on_volume(load.kind) && load.body.empty()) {
    std::vector<std::size_t> all(system.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  return {chosen_body(system, load.body, what, [&](std::size_t b) {
    const TrimmedModel& model = system[b].space->model();
    if (load.place.given())
      choose_places(model, load.place, what);
    else
      choose_polygons(model, load.region, what);
  })};
}

} // namespace

SystemLoad assemble_load(const BodySystem& system, const Load& load) {
  SystemLoad all;
  all.load = Eigen::VectorXd::Zero(system.num_unknowns());
  all.of_body.resize(system.size());
  all.bodies = bodies_of_load(system, load);
  for (const std::size_t b : all.bodies) {
    const SystemBody& body = system[b];
    LoadTerms terms = assemble_loads(*body.space, body.material.density, std::span(&load, 1));
    system.part(all.load, b) += terms.load;
    if (auto force = volume_force(load, body.material.density))
      all.of_body[b].body_force = std::move(*force);
    else
      (load.rigid ? all.of_body[b].rigid : all.of_body[b].surfaces).push_back(std::move(terms.surfaces[0]));
    terms.reports[0].force = plus(terms.reports[0].force, all.report.force);
    terms.reports[0].moment = plus(terms.reports[0].moment, all.report.moment);
    all.report = std::move(terms.reports[0]);
  }
  if (all.bodies.size() == 1) all.report.region.body = system.name_among_several(all.bodies[0]);
  return all;
}

void add_masses(const BodySystem& system, std::span<const PreparedMass> masses, const Load& load, SystemLoad& all) {
  if (!acts_on_mass(load.kind)) return;
  for (const PreparedMass& mass : masses) {
    if (std::find(all.bodies.begin(), all.bodies.end(), mass.body) == all.bodies.end()) continue;
    const Eigen::VectorXd force = inertia_force(system, mass, load);
    const Eigen::Matrix<double, 6, 1> sum = rigid_motions(system, Point3{}).transpose() * force;
    all.load += force;
    all.report.force = plus(all.report.force, as_point(sum.head<3>()));
    all.report.moment = plus(all.report.moment, as_point(sum.tail<3>()));
  }
}

std::vector<SystemLoad> assemble_loads(const BodySystem& system, std::span<const Load> loads) {
  std::vector<SystemLoad> all;
  for (const Load& load : loads) all.push_back(assemble_load(system, load));
  return all;
}

std::vector<LocatedProbe> locate_probes(const BodySystem& system, std::span<const Probe> probes) {
  std::vector<LocatedProbe> located;
  if (probes.empty()) return located;
  std::vector<Locator> locators;
  for (const SystemBody& body : system) locators.emplace_back(body.space->model());
  for (const Probe& probe : probes) {
    const std::string what = fmt::format("probe '{}'", probe.name);
    const std::size_t b =
        chosen_body(system, probe.body, what, [&](std::size_t body) { locators[body].locate(probe.position, what); });
    located.push_back({b, locators[b].locate(probe.position, what)});
  }
  return located;
}

} // namespace iga::solve
