#include "solver/analysis/static_analysis.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/supports/rigid_regions.hpp"
#include "solver/supports/support_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace iga::solve {

namespace {

// A residual above this after refinement means that digits were lost in the factorisation.
constexpr double largest_residual = 1e-8;

void need_no_free_motion(const SolutionSpace& space, const NodePattern& pattern,
                         std::span<const PreparedSupport> supports) {
  const std::vector<std::string> free = free_rigid_motions(space, pattern, supports);
  if (free.empty()) return;
  throw InputError(fmt::format("{}: a static analysis needs supports that resist every rigid motion:\n  {}\n"
                               "add a [[support]] or fix more components",
                               supports.empty() ? "no support is given" : "the supports do not hold the part",
                               fmt::join(free, "\n  ")));
}

std::unique_ptr<LinearSolver> factorise(const StiffnessMatrix& K, const SupportTerms& supports,
                                        io::Progress* progress) {
  SystemMatrix system;
  system.announce = show_factorisation(progress);
  system.stiffness = &K;
  if (supports.constraints.rows() == 0) return factorise_positive_definite(system);
  system.constraints = &supports.constraints;
  return factorise_indefinite(system);
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

void find_largest(const std::vector<double>& positions, const FieldSamples& fields, StaticSolution& solution) {
  for (std::size_t q = 0; q < fields.von_mises.size(); ++q) {
    const Point3 x{positions[3 * q], positions[3 * q + 1], positions[3 * q + 2]};
    const double u = norm({fields.displacement[3 * q], fields.displacement[3 * q + 1], fields.displacement[3 * q + 2]});
    if (u > solution.largest_displacement) {
      solution.largest_displacement = u;
      solution.largest_displacement_at = x;
    }
    if (fields.von_mises[q] > solution.largest_von_mises) {
      solution.largest_von_mises = fields.von_mises[q];
      solution.largest_von_mises_at = x;
    }
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

// Supports and loads with their moments about the centroids of what they act on.
void describe_forces(const StaticSettings& settings, const SupportTerms& supports, const TrimmedModel& model,
                     StaticSolution& solution) {
  for (std::size_t s = 0; s < supports.prepared.size(); ++s) {
    const RegionReport& region = supports.regions[s];
    const Reaction& reaction = solution.reactions[s];
    solution.result.supports.push_back({reaction.name, name_of(supports.prepared[s].support.method), region.area,
                                        region.centroid, reaction.force,
                                        moment_about(region.centroid, reaction.moment, reaction.force)});
    solution.force_balance = plus(solution.force_balance, reaction.force);
    solution.moment_balance = plus(solution.moment_balance, reaction.moment);
    solution.result.support_work += reaction.work;
    solution.result.gap_work += reaction.gap_work;
    solution.result.penalty_energy += reaction.penalty_energy;
  }
  Point3 centroid{};
  double volume = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* x = solution.result.positions.data() + 3 * q;
    centroid = plus(centroid, times({x[0], x[1], x[2]}, model.points.weights[q]));
    volume += model.points.weights[q];
  }
  for (std::size_t k = 0; k < settings.loads.size(); ++k) {
    const LoadReport& load = solution.loads[k];
    const LoadKind kind = settings.loads[k].kind;
    Point3 centre = load.region.centroid;
    if (kind == LoadKind::BodyForce || kind == LoadKind::Acceleration) centre = times(centroid, 1 / volume);
    solution.result.loads.push_back({load.name, name_of(kind), load.region.area, centre, load.force,
                                     moment_about(centre, load.moment, load.force)});
    solution.force_balance = plus(solution.force_balance, load.force);
    solution.moment_balance = plus(solution.moment_balance, load.moment);
  }
}

std::vector<double> as_vector(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

} // namespace

double energy_defect(const StaticResult& r) {
  const double stored = r.strain_energy + r.penalty_energy, done = r.external_work + r.support_work + r.gap_work;
  const double larger = std::max(std::abs(stored), std::abs(done));
  return larger > 0 ? std::abs(stored - done) / larger : 0;
}

std::optional<std::string> singular_place_near(const StaticSolution& solution, const SplineGrid& grid,
                                               const Point3& x) {
  const double reach = singular_reach(grid);
  const auto is_near = [&](const RegionReport& region) {
    return std::any_of(region.places.begin(), region.places.end(),
                       [&](const Point3& place) { return norm(minus(place, x)) < reach; });
  };
  for (const RegionReport& support : solution.regions)
    if (is_near(support)) return fmt::format("support '{}'", support.name);
  for (const LoadReport& load : solution.loads)
    if (is_near(load.region)) return fmt::format("load '{}'", load.name);
  return std::nullopt;
}

StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const SolutionSpace& space) {
  const TrimmedModel& model = space.model();
  StaticSolution solution;
  Stopwatch watch(solution.timings);

  const std::vector<LocatedPoint> probes = locate_probes(model, settings.probes);
  LoadTerms loads = assemble_loads(space, run.material.density, settings.loads);
  solution.loads = loads.reports;
  watch.stage("loads");
  show_stage(run.progress, "assembly");
  const auto connectivity = std::make_shared<const Connectivity>(space);
  StiffnessMatrix K = assemble_stiffness(space, connectivity, run.material);
  watch.stage("stiffness");
  show_stage(run.progress, "supports");
  const SupportTerms supports = apply_supports(space, run.material, run.supports, K);
  RigidRegions rigid(space, run.material, settings.loads, K);
  need_no_free_motion(space, K.pattern(), supports.prepared);
  solution.regions = supports.regions;
  solution.num_constraints = supports.constraints.rows();
  solution.warnings = region_warnings(supports, model.grid);
  const std::vector<std::string> of_loads = region_warnings(solution.loads, model.grid);
  solution.warnings.insert(solution.warnings.end(), of_loads.begin(), of_loads.end());
  watch.stage("supports");

  Eigen::VectorXd b(K.size() + supports.constraints.rows());
  b << loads.load + supports.load, supports.values;
  show_stage(run.progress, "analysis of the matrix");
  const auto solver = factorise(K, supports, run.progress);
  solution.cost = solver->cost();
  watch.stage("factorisation");
  show_stage(run.progress, "solution");
  rigid.prepare(*solver);
  Eigen::VectorXd x = rigid.solve(*solver, b);
  x += rigid.solve(*solver, residual(K, rigid, supports.constraints, b, x));
  const double size = b.norm();
  solution.residual = residual(K, rigid, supports.constraints, b, x).norm() / (size > 0 ? size : 1);
  // Forces that cancel in the motion of rigid regions leave their rounding.
  const double rounding =
      64 * std::numeric_limits<double>::epsilon() * rigid.correction(Eigen::VectorXd(x.head(K.size()))).norm();
  if (!(solution.residual < largest_residual || solution.residual * size < rounding))
    throw NumericalError(fmt::format("the static system could not be solved: relative residual {:.2g} after "
                                     "refinement, expected below {:.0e}; the part is hardly held, or functions hold "
                                     "almost no material",
                                     solution.residual, largest_residual));
  solution.unknowns = x.head(K.size());
  solution.multipliers = x.tail(supports.constraints.rows());
  watch.stage("solution");

  show_stage(run.progress, "fields");
  StaticResult& result = solution.result;
  result.displacement = as_vector(space.expand(solution.unknowns));
  result.positions = positions_of(model.grid, model.points.parameters);
  result.points = recover_fields(space, run.material, solution.unknowns, model.points.offsets, model.points.parameters);
  const auto& surface = model.surface.quadrature;
  solution.surface = recover_fields(space, run.material, solution.unknowns, surface.offsets, surface.parameters);
  result.probes = recover_probes(space, run.material, solution.unknowns, settings.probes, probes);
  result.strain_energy = strain_energy(model, result.points);
  result.external_work = 0.5 * loads.load.dot(solution.unknowns);
  find_largest(result.positions, result.points, solution);
  find_largest(positions_of(model.grid, surface.parameters), solution.surface, solution);
  solution.reactions = reactions(space, run.material, supports, solution.unknowns, solution.multipliers);
  solution.motions = rigid.motions(solution.unknowns);
  result.penalty_energy = rigid.energy(solution.unknowns);
  describe_forces(settings, supports, model, solution);
  watch.stage("fields");
  return solution;
}

} // namespace iga::solve
