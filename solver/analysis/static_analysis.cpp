#include "solver/analysis/static_analysis.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/field_errors.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/supports/body_choice.hpp"
#include "solver/supports/rigid_regions.hpp"
#include "solver/supports/support_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <numeric>

namespace iga::solve {

namespace {

// A residual above this after refinement means that digits were lost in the factorisation.
constexpr double largest_residual = 1e-8;

void need_no_free_motion(const BodySystem& system, const BoundSystem& bound) {
  const std::vector<std::string> free = free_rigid_motions(system, bound.K.pattern(), bound.of_body);
  if (free.empty()) return;
  throw InputError(fmt::format("{}: a static analysis needs supports that resist every rigid motion:\n  {}\n"
                               "add a [[support]] or fix more components{}",
                               bound.regions.empty() ? "no support is given" : "the supports do not hold the part",
                               fmt::join(free, "\n  "),
                               system.size() > 1 ? ", or tie the body to another one ([[ties]])" : ""));
}

std::unique_ptr<LinearSolver> factorise(const BoundSystem& bound, io::Progress* progress) {
  SystemMatrix system;
  system.announce = show_factorisation(progress);
  system.stiffness = &bound.K;
  if (bound.constraints.rows() == 0) return factorise_positive_definite(system);
  system.constraints = &bound.constraints;
  return factorise_indefinite(system);
}

/// Loads of all bodies.
struct SystemLoads {
  Eigen::VectorXd load;                         ///< (num_unknowns)
  std::vector<LoadReport> reports;              ///< by load of the run
  std::vector<std::vector<std::size_t>> bodies; ///< by load of the run: those that it acts on
  std::vector<BodyLoads> of_body;               ///< by body, what acts on it
};

std::vector<std::size_t> bodies_of_load(const BodySystem& system, const Load& load) {
  const std::string what = fmt::format("load '{}'", load.name);
  const bool everywhere = load.kind == LoadKind::BodyForce || load.kind == LoadKind::Acceleration;
  if (everywhere && load.body.empty()) {
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

SystemLoads assemble_loads(const BodySystem& system, std::span<const Load> loads) {
  SystemLoads all;
  all.load = Eigen::VectorXd::Zero(system.num_unknowns());
  all.of_body.resize(system.size());
  for (const Load& load : loads) {
    all.bodies.push_back(bodies_of_load(system, load));
    LoadReport sum;
    for (const std::size_t b : all.bodies.back()) {
      const SystemBody& body = system[b];
      LoadTerms terms = assemble_loads(*body.space, body.material.density, std::span(&load, 1));
      system.part(all.load, b) += terms.load;
      if (const auto force = volume_force(load, body.material.density))
        all.of_body[b].body_force += as_vector(*force);
      else
        (load.rigid ? all.of_body[b].rigid : all.of_body[b].surfaces).push_back(std::move(terms.surfaces[0]));
      terms.reports[0].force = plus(terms.reports[0].force, sum.force);
      terms.reports[0].moment = plus(terms.reports[0].moment, sum.moment);
      sum = std::move(terms.reports[0]);
    }
    if (all.bodies.back().size() == 1) sum.region.body = system.name_among_several(all.bodies.back()[0]);
    all.reports.push_back(std::move(sum));
  }
  return all;
}

/// Where probes lie, found before anything is computed.
struct LocatedProbe {
  std::size_t body = 0;
  LocatedPoint place;
};

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

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

ProbeResult recover_probes(const BodySystem& system, const Eigen::VectorXd& u, std::span<const Probe> probes,
                           std::span<const LocatedProbe> located) {
  ProbeResult all;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const SystemBody& body = system[located[k].body];
    const ProbeResult one = recover_probes(*body.space, body.material, system.part(u, located[k].body),
                                           probes.subspan(k, 1), std::span(&located[k].place, 1));
    all.names.push_back(one.names[0]);
    append(all.positions, one.positions);
    append(all.fields.displacement, one.fields.displacement);
    append(all.fields.strain, one.fields.strain);
    append(all.fields.stress, one.fields.stress);
    append(all.fields.von_mises, one.fields.von_mises);
  }
  return all;
}

Eigen::VectorXd residual(const StiffnessMatrix& K, const RigidRegions& rigid, const ConstraintMatrix& C,
                         const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  const Eigen::Index n = K.size();
  Eigen::VectorXd r = b;
  r.head(n) += rigid.correction(x.head(n)) - K * Eigen::VectorXd(x.head(n));
  if (C.rows() > 0) {
    r.head(n) -= C.transpose() * x.tail(C.rows());
    r.tail(C.rows()) -= C * x.head(n);
  }
  return r;
}

std::vector<double> positions_of(const SplineGrid& grid, const std::vector<double>& parameters) {
  std::vector<double> positions(parameters.size());
  for (std::size_t q = 0; 3 * q < parameters.size(); ++q) {
    const Point3 x = grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
    std::copy(x.begin(), x.end(), positions.begin() + static_cast<std::ptrdiff_t>(3 * q));
  }
  return positions;
}

void offer(LargestValue& largest, double value, const Point3& at, std::size_t body) {
  if (value > largest.value) largest = {value, at, body};
}

void find_largest(const std::vector<double>& positions, const FieldSamples& fields, std::size_t body,
                  StaticSolution& solution) {
  for (std::size_t q = 0; q < fields.von_mises.size(); ++q) {
    const Point3 x{positions[3 * q], positions[3 * q + 1], positions[3 * q + 2]};
    const double* u = fields.displacement.data() + 3 * q;
    offer(solution.largest_displacement, norm({u[0], u[1], u[2]}), x, body);
    offer(solution.largest_von_mises, fields.von_mises[q], x, body);
  }
}

const char* name_of(SupportMethod method) {
  switch (method) {
  case SupportMethod::Penalty:
    return "penalty";
  case SupportMethod::Lagrange:
    return "lagrange";
  default:
    return "nitsche";
  }
}

Point3 moment_about(const Point3& centre, const Point3& moment, const Point3& force) {
  return minus(moment, cross(centre, force));
}

// Of the material of some bodies.
Point3 centroid_of(const BodySystem& system, std::span<const std::size_t> bodies) {
  Point3 first_moment{};
  double volume = 0;
  for (const std::size_t b : bodies) {
    const TrimmedModel& model = system[b].space->model();
    const std::vector<double> positions = positions_of(model.grid, model.points.parameters);
    for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
      const double* x = positions.data() + 3 * q;
      first_moment = plus(first_moment, times({x[0], x[1], x[2]}, model.points.weights[q]));
      volume += model.points.weights[q];
    }
  }
  return times(first_moment, 1 / volume);
}

// Supports and loads with their moments about the centroids of what they act on.
void describe_forces(const RunSettings& run, const StaticSettings& settings, const BodySystem& system,
                     const SystemLoads& loads, StaticSolution& solution) {
  for (std::size_t s = 0; s < run.supports.size(); ++s) {
    const RegionReport& region = solution.regions[s];
    const Reaction& reaction = solution.reactions[s];
    solution.result.supports.push_back({reaction.name, name_of(run.supports[s].method), region.area, region.centroid,
                                        reaction.force,
                                        moment_about(region.centroid, reaction.moment, reaction.force)});
    solution.force_balance = plus(solution.force_balance, reaction.force);
    solution.moment_balance = plus(solution.moment_balance, reaction.moment);
    solution.result.support_work += reaction.work;
    solution.result.gap_work += reaction.gap_work;
    solution.result.penalty_energy += reaction.penalty_energy;
  }
  for (const TieForce& tie : solution.tie_forces) {
    solution.result.gap_work += tie.gap_work;
    solution.result.penalty_energy += tie.penalty_energy;
  }
  for (std::size_t k = 0; k < settings.loads.size(); ++k) {
    const LoadReport& load = solution.loads[k];
    const LoadKind kind = settings.loads[k].kind;
    Point3 centre = load.region.centroid;
    if (kind == LoadKind::BodyForce || kind == LoadKind::Acceleration) centre = centroid_of(system, loads.bodies[k]);
    solution.result.loads.push_back({load.name, name_of(kind), load.region.area, centre, load.force,
                                     moment_about(centre, load.moment, load.force)});
    solution.force_balance = plus(solution.force_balance, load.force);
    solution.moment_balance = plus(solution.moment_balance, load.moment);
  }
}

std::vector<double> entries_of(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

} // namespace

double energy_defect(const StaticResult& r) {
  const double stored = r.strain_energy + r.penalty_energy, done = r.external_work + r.support_work + r.gap_work;
  const double larger = std::max(std::abs(stored), std::abs(done));
  return larger > 0 ? std::abs(stored - done) / larger : 0;
}

std::optional<StaticErrors> relative_errors(const StaticSolution& solution) {
  const double energy = 2 * solution.result.strain_energy; // a(u, u)
  if (!solution.energy_error || !(energy > 0)) return std::nullopt;
  const double share = *solution.energy_error / energy;
  return StaticErrors{share, std::sqrt(share)};
}

std::optional<std::string> singular_place_near(const StaticSolution& solution, const std::string& body,
                                               const Point3& x) {
  const auto is_near = [&](const RegionReport& region) {
    return region.body == body && std::any_of(region.places.begin(), region.places.end(), [&](const Point3& place) {
             return norm(minus(place, x)) < region.reach;
           });
  };
  for (const RegionReport& support : solution.regions)
    if (is_near(support)) return fmt::format("support '{}'", support.name);
  for (const LoadReport& load : solution.loads)
    if (is_near(load.region)) return fmt::format("load '{}'", load.name);
  return std::nullopt;
}

namespace {

StaticBody recover_body(const SystemBody& body, const Eigen::VectorXd& u) {
  const SolutionSpace& space = *body.space;
  const TrimmedModel& model = space.model();
  const auto& surface = model.surface.quadrature;
  return {entries_of(space.expand(u)), positions_of(model.grid, model.points.parameters),
          recover_fields(space, body.material, u, model.points.offsets, model.points.parameters),
          recover_fields(space, body.material, u, surface.offsets, surface.parameters)};
}

void recover_bodies(const BodySystem& system, StaticSolution& solution) {
  for (std::size_t b = 0; b < system.size(); ++b) {
    const TrimmedModel& model = system[b].space->model();
    StaticBody fields = recover_body(system[b], system.part(solution.unknowns, b));
    solution.result.strain_energy += strain_energy(model, fields.points);
    find_largest(fields.positions, fields.points, b, solution);
    find_largest(positions_of(model.grid, model.surface.quadrature.parameters), fields.surface, b, solution);
    solution.bodies.push_back(std::move(fields));
  }
  if (system.size() > 1) return;
  StaticBody& only = solution.bodies[0];
  solution.result.displacement = std::move(only.displacement);
  solution.result.positions = std::move(only.positions);
  solution.result.points = std::move(only.points);
  solution.surface = std::move(only.surface);
  solution.bodies.clear();
}

bool is_line_or_point(const RegionReport& region) {
  return region.extent != Extent::Surface;
}

std::string no_energy_error(const BodySystem& system, const StaticSolution& solution) {
  if (std::any_of(solution.regions.begin(), solution.regions.end(), is_line_or_point))
    return "under a support on a line or at a point stress grows without limit as spans get smaller";
  if (std::any_of(solution.loads.begin(), solution.loads.end(),
                  [](const LoadReport& load) { return is_line_or_point(load.region); }))
    return "under a load on a line or at a point the energy grows without limit as spans get smaller";
  return no_field_errors(system);
}

void estimate_error(const BodySystem& system, const BoundSystem& bound, const SystemLoads& loads,
                    StaticSolution& solution) {
  solution.no_energy_error = no_energy_error(system, solution);
  if (!solution.no_energy_error.empty()) return;
  solution.energy_error =
      total_errors(field_errors(system, bound, solution.unknowns, Eigen::VectorXd::Zero(1), loads.of_body))[0];
}

void solve(const BoundSystem& bound, const RigidRegions& rigid, const Eigen::VectorXd& b, const LinearSolver& solver,
           StaticSolution& solution) {
  Eigen::VectorXd x = rigid.solve(solver, b);
  x += rigid.solve(solver, residual(bound.K, rigid, bound.constraints, b, x));
  const double size = b.norm();
  solution.residual = residual(bound.K, rigid, bound.constraints, b, x).norm() / (size > 0 ? size : 1);
  // Forces that cancel in the motion of rigid regions leave their rounding.
  const double rounding =
      64 * std::numeric_limits<double>::epsilon() * rigid.correction(Eigen::VectorXd(x.head(bound.K.size()))).norm();
  if (!(solution.residual < largest_residual || solution.residual * size < rounding))
    throw NumericalError(fmt::format("the static system could not be solved: relative residual {:.2g} after "
                                     "refinement, expected below {:.0e}; the part is hardly held, or functions hold "
                                     "almost no material",
                                     solution.residual, largest_residual));
  solution.unknowns = x.head(bound.K.size());
  solution.multipliers = x.tail(bound.constraints.rows());
}

} // namespace

StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const SolutionSpace& space) {
  return run_static(run, settings, BodySystem(space, run.material));
}

StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const BodySystem& system) {
  StaticSolution solution;
  Stopwatch watch(solution.timings);

  const std::vector<LocatedProbe> probes = locate_probes(system, settings.probes);
  const SystemLoads loads = assemble_loads(system, settings.loads);
  solution.loads = loads.reports;
  watch.stage("loads");
  BoundSystem bound = bind_system(system, run, watch);
  RigidRegions rigid(system, settings.loads, loads.bodies, bound.K);
  need_no_free_motion(system, bound);
  solution.regions = bound.regions;
  solution.ties = bound.tie_reports;
  solution.num_constraints = bound.constraints.rows();
  solution.warnings = region_warnings(solution.regions);
  const std::vector<std::string> of_loads = region_warnings(solution.loads);
  solution.warnings.insert(solution.warnings.end(), of_loads.begin(), of_loads.end());
  watch.stage("supports");

  Eigen::VectorXd b(bound.K.size() + bound.constraints.rows());
  b << loads.load + bound.load, bound.values;
  show_stage(run.progress, "analysis of the matrix");
  const auto solver = factorise(bound, run.progress);
  solution.cost = solver->cost();
  watch.stage("factorisation");
  show_stage(run.progress, "solution");
  rigid.prepare(*solver);
  solve(bound, rigid, b, *solver, solution);
  watch.stage("solution");

  show_stage(run.progress, "fields");
  recover_bodies(system, solution);
  for (const LocatedProbe& probe : probes) solution.probe_bodies.push_back(system.name_among_several(probe.body));
  solution.result.probes = recover_probes(system, solution.unknowns, settings.probes, probes);
  solution.result.external_work = 0.5 * loads.load.dot(solution.unknowns);
  solution.reactions = reactions(system, bound, solution.unknowns, solution.multipliers);
  solution.tie_forces = tie_forces(system, bound.ties, solution.unknowns);
  solution.motions = rigid.motions(solution.unknowns);
  solution.result.penalty_energy = rigid.energy(solution.unknowns);
  describe_forces(run, settings, system, loads, solution);
  watch.stage("fields");
  show_stage(run.progress, "errors");
  estimate_error(system, bound, loads, solution);
  watch.stage("errors");
  return solution;
}

} // namespace iga::solve
