#include "solver/analysis/static_analysis.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/field_errors.hpp"
#include "solver/analysis/inertia_relief.hpp"
#include "solver/analysis/static_solver.hpp"
#include "solver/analysis/system_loads.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/supports/body_choice.hpp"
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

// A shank that bears less than this share of its own stiffness when it is shortened is free: rounding.
constexpr double free_shank = 1e-7;

using Timings = std::vector<std::pair<std::string, double>>;

void need_no_free_motion(const BodySystem& system, const BoundSystem& bound) {
  const std::vector<std::string> free = free_rigid_motions(system, bound.K.pattern(), bound.of_body, bound.springs);
  if (free.empty()) return;
  throw InputError(fmt::format("{}: a static analysis needs supports that resist every rigid motion:\n  {}\n"
                               "add a [[support]] or fix more components{}",
                               bound.regions.empty() && bound.springs.empty() ? "no support is given"
                               : bound.springs.empty()                        ? "the supports do not hold the part"
                                                       : "supports and springs do not hold the part",
                               fmt::join(free, "\n  "),
                               system.size() > 1 ? ", or tie the body to another one ([[ties]])" : ""));
}

BodyForce sum_of(BodyForce a, BodyForce b) {
  if (!a) return b;
  return [a = std::move(a), b = std::move(b)](const Point3& x) { return plus(a(x), b(x)); };
}

/// What acts in one case: the loads of the run with their factors.
struct CaseLoads {
  Eigen::VectorXd load; ///< (num_unknowns): of loads alone
  std::vector<LoadReport> reports;
  std::vector<BodyLoads> of_body;
};

void add_times(double factor, const BodyLoads& load, BodyLoads& sum) {
  if (factor == 0) return;
  if (load.body_force)
    sum.body_force = sum_of(std::move(sum.body_force),
                            [factor, b = load.body_force](const Point3& x) { return times(b(x), factor); });
  for (const SurfaceLoad& surface : load.surfaces)
    sum.surfaces.push_back({surface.region, [factor, t = surface.traction](const Point3& x, const Point3& n) {
                              return times(t(x, n), factor);
                            }});
  sum.rigid.insert(sum.rigid.end(), load.rigid.begin(), load.rigid.end());
}

CaseLoads loads_of(const LoadCase& one, std::span<const SystemLoad> loads, const BodySystem& system) {
  CaseLoads sum{Eigen::VectorXd::Zero(system.num_unknowns()), {}, std::vector<BodyLoads>(system.size())};
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const double factor = one.factors[k];
    sum.load += factor * loads[k].load;
    sum.reports.push_back(loads[k].report);
    sum.reports.back().force = times(loads[k].report.force, factor);
    sum.reports.back().moment = times(loads[k].report.moment, factor);
    for (std::size_t b = 0; b < system.size(); ++b) add_times(factor, loads[k].of_body[b], sum.of_body[b]);
  }
  return sum;
}

/// The bodies' temperatures and the strains that they make.
struct ThermalLoad {
  std::vector<BodyTemperature> of_body;                   ///< empty where there is no [temperature]
  std::vector<std::shared_ptr<const StrainField>> strain; ///< by body
};

/// Bolts of the run, each with the strain of its shank shortened by one length.
struct TightenedBolts {
  std::vector<std::size_t> body;
  std::vector<std::shared_ptr<const StrainField>> unit;
  std::vector<double> section; ///< length²
  Eigen::VectorXd shortening;  ///< (bolts), length
};

using Shares = std::vector<std::vector<StrainShare>>; // by body

// The system whose materials have these initial strains.
BodySystem strained(const BodySystem& system, const Shares& shares) {
  BodySystem bodies;
  for (std::size_t b = 0; b < system.size(); ++b) {
    ElasticMaterial material = system[b].material;
    material.initial_strain = sum_of(shares[b]);
    bodies.add(system[b].name, system[b].space, material);
  }
  return bodies;
}

Shares shares_of(const LoadCase& one, const ThermalLoad& thermal, const TightenedBolts& bolts, std::size_t bodies) {
  Shares shares(bodies);
  for (std::size_t b = 0; b < thermal.strain.size(); ++b) shares[b].push_back({one.temperature, thermal.strain[b]});
  for (std::size_t k = 0; k < bolts.unit.size(); ++k)
    shares[bolts.body[k]].push_back({one.bolts[k] * bolts.shortening[static_cast<Eigen::Index>(k)], bolts.unit[k]});
  return shares;
}

TightenedBolts find_bolts(const BodySystem& system, std::span<const Bolt> bolts) {
  TightenedBolts found;
  for (const Bolt& bolt : bolts) {
    const auto section_in = [&](std::size_t b) {
      return shank_section(bolt, *shortening(bolt, *system[b].space), system[b].space->model());
    };
    const std::size_t b = chosen_body(system, bolt.body, fmt::format("bolt '{}'", bolt.name),
                                      [&](std::size_t body) { section_in(body); });
    found.body.push_back(b);
    found.section.push_back(section_in(b));
    found.unit.push_back(shortening(bolt, *system[b].space));
  }
  return found;
}

ThermalLoad thermal_load(const StaticSettings& settings, const BodySystem& system) {
  ThermalLoad thermal;
  if (!settings.temperature) return thermal;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SystemBody& body = system[b];
    const std::string name = system.name_among_several(b);
    if (!body.material.expansion)
      throw InputError(fmt::format("{}: {}the material has no thermal expansion; give expansion (1/temperature) in its "
                                   "material, or a named material that has one",
                                   settings.temperature->where, name.empty() ? "" : fmt::format("body '{}': ", name)));
    thermal.of_body.push_back(make_temperature(*settings.temperature, *body.space, name));
    thermal.strain.push_back(
        thermal_strain(thermal.of_body.back().field, settings.temperature->reference, *body.material.expansion));
  }
  return thermal;
}

Eigen::VectorXd load_of_strains(const BodySystem& strained, const BoundSystem& bound) {
  Eigen::VectorXd load = initial_strain_load(strained, bound.ties);
  for (std::size_t b = 0; b < strained.size(); ++b) {
    const SystemBody& body = strained[b];
    strained.part(load, b) += initial_strain_load(*body.space, body.material) +
                              initial_strain_load(*body.space, body.material, bound.of_body[b]);
  }
  return load;
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

// The displacements that supports prescribe, times a factor, while it lives: reactions are those of a case.
class PrescribedFactor {
 public:
  PrescribedFactor(BoundSystem& bound, double factor) : bound_(bound) {
    if (factor == 1) return;
    kept_ = bound.of_body;
    for (SupportTerms& terms : bound.of_body) {
      terms.values *= factor;
      for (PreparedSupport& prepared : terms.prepared) {
        prepared.support.value = times(prepared.support.value, factor);
        for (Point3& row : prepared.support.gradient) row = times(row, factor);
      }
    }
  }
  ~PrescribedFactor() {
    if (!kept_.empty()) bound_.of_body = std::move(kept_);
  }
  PrescribedFactor(const PrescribedFactor&) = delete;
  PrescribedFactor& operator=(const PrescribedFactor&) = delete;

 private:
  BoundSystem& bound_;
  std::vector<SupportTerms> kept_;
};

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
                     std::span<const SystemLoad> loads, StaticSolution& solution) {
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
  for (std::size_t k = 0; k < solution.attached.springs.size(); ++k) {
    const RegionReport& region = solution.attached.springs[k].region;
    const SpringForce& f = solution.spring_forces[k];
    solution.result.springs.push_back({region.name, region.area, region.centroid, f.force,
                                       moment_about(region.centroid, f.moment, f.force), f.energy});
    if (!solution.attached.springs[k].spring.to) { // two ends balance each other
      solution.force_balance = plus(solution.force_balance, f.force);
      solution.moment_balance = plus(solution.moment_balance, f.moment);
    }
    solution.result.spring_energy += f.energy;
  }
  for (const TieForce& tie : solution.tie_forces) {
    solution.result.gap_work += tie.gap_work;
    solution.result.penalty_energy += tie.penalty_energy;
  }
  for (std::size_t k = 0; k < settings.loads.size(); ++k) {
    const LoadReport& load = solution.loads[k];
    const LoadKind kind = settings.loads[k].kind;
    Point3 centre = load.region.centroid;
    if (acts_on_volume(kind)) centre = centroid_of(system, loads[k].bodies);
    solution.result.loads.push_back({load.name, name_of(kind), load.region.area, centre, load.force,
                                     moment_about(centre, load.moment, load.force)});
    solution.force_balance = plus(solution.force_balance, load.force);
    solution.moment_balance = plus(solution.moment_balance, load.moment);
  }
  for (const RigidAcceleration& a : solution.relief) {
    solution.force_balance = plus(solution.force_balance, a.inertia_force);
    solution.moment_balance = plus(solution.moment_balance, a.inertia_moment);
  }
}

std::vector<double> entries_of(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

} // namespace

double energy_defect(const StaticResult& r) {
  const double stored = r.strain_energy + r.spring_energy + r.penalty_energy,
               done = r.external_work + r.support_work + r.gap_work + r.initial_strain_work;
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
  for (const auto& spring : solution.attached.springs)
    if (is_near(spring.region)) return fmt::format("spring '{}'", spring.region.name);
  for (const auto& mass : solution.attached.masses)
    if (is_near(mass.region)) return fmt::format("added mass '{}'", mass.region.name);
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
    const double work = initial_strain_work(model, system[b].material, fields.points);
    solution.result.strain_energy += strain_energy(model, fields.points) + work;
    solution.result.initial_strain_work += work;
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
  const auto at_line_or_point = [](const auto& part) { return is_line_or_point(part.region); };
  const AttachedParts& attached = solution.attached;
  if (std::any_of(attached.springs.begin(), attached.springs.end(), at_line_or_point) ||
      std::any_of(attached.masses.begin(), attached.masses.end(), at_line_or_point))
    return "under a spring or an added mass on a line or at a point stress grows without limit as spans get smaller";
  if (std::any_of(solution.loads.begin(), solution.loads.end(),
                  [](const LoadReport& load) { return is_line_or_point(load.region); }))
    return "under a load on a line or at a point the energy grows without limit as spans get smaller";
  for (const SystemBody& body : system)
    if (body.material.initial_strain && !body.material.initial_strain->is_smooth())
      return "the strains given jump from place to place";
  return no_field_errors(system);
}

void estimate_error(const BodySystem& system, const BoundSystem& bound, std::span<const BodyLoads> loads,
                    StaticSolution& solution) {
  solution.no_energy_error = no_energy_error(system, solution);
  if (!solution.no_energy_error.empty()) return;
  solution.energy_error =
      total_errors(field_errors(system, bound, solution.unknowns, Eigen::VectorXd::Zero(1), loads))[0];
}

/// The factorised system with all that its solutions need.
struct SolvableSystem {
  const BoundSystem& bound;
  const RigidRegions& rigid;
  const LinearSolver& solver;
  const InertiaRelief* relief = nullptr; ///< then the factor is that of K + σ M
};

// One step of refinement; as many as it takes where the factor is that of K + σ M.
Eigen::VectorXd refined(const SolvableSystem& system, const Eigen::VectorXd& b) {
  const auto left = [&](const Eigen::VectorXd& x) {
    return residual(system.bound.K, system.rigid, system.bound.constraints, b, x);
  };
  Eigen::VectorXd x = system.rigid.solve(system.solver, b);
  if (!system.relief) {
    x += system.rigid.solve(system.solver, left(x));
    return x;
  }
  constexpr int most_steps = 30;
  constexpr double little = 0.5; // of the residual before: the rest is rounding
  x = system.relief->without_rigid(x);
  Eigen::VectorXd r = left(x);
  for (int step = 0; step < most_steps && r.norm() > 0; ++step) {
    const Eigen::VectorXd next = system.relief->without_rigid(x + system.rigid.solve(system.solver, r));
    const Eigen::VectorXd rest = left(next);
    const bool better = rest.norm() < r.norm(), much = rest.norm() < little * r.norm();
    if (better) {
      x = next;
      r = rest;
    }
    if (!much) break;
  }
  return x;
}

void solve(const SolvableSystem& system, const Eigen::VectorXd& b, StaticSolution& solution) {
  const BoundSystem& bound = system.bound;
  const Eigen::VectorXd x = refined(system, b);
  const double size = b.norm();
  solution.residual = residual(bound.K, system.rigid, bound.constraints, b, x).norm() / (size > 0 ? size : 1);
  // Forces that cancel in the motion of rigid regions leave their rounding.
  const double rounding = 64 * std::numeric_limits<double>::epsilon() *
                          system.rigid.correction(Eigen::VectorXd(x.head(bound.K.size()))).norm();
  if (!(solution.residual < largest_residual || solution.residual * size < rounding))
    throw NumericalError(fmt::format("the static system could not be solved: relative residual {:.2g} after "
                                     "refinement, expected below {:.0e}; the part is hardly held, or functions hold "
                                     "almost no material",
                                     solution.residual, largest_residual));
  solution.unknowns = x.head(bound.K.size());
  solution.multipliers = x.tail(bound.constraints.rows());
}

std::vector<LoadCase> cases_of(const StaticSettings& settings) {
  if (!settings.cases.empty()) return settings.cases;
  return {{"", std::vector<double>(settings.loads.size(), 1.0), std::vector<double>(settings.bolts.size(), 1.0), 1, 1}};
}

void add_temperatures(const StaticSettings& settings, const LoadCase& one, const ThermalLoad& thermal,
                      const BodySystem& system, StaticSolution& solution) {
  for (std::size_t b = 0; b < thermal.of_body.size(); ++b) {
    const BodyTemperature& T = thermal.of_body[b];
    solution.temperatures.push_back(
        {system.name_among_several(b), T.source, T.least, T.most, settings.temperature->reference, one.temperature});
  }
}

// Shortenings that give every bolt its preload where bolts alone act: one solution for each of them.
void tighten(const SolvableSystem& solvable, const BodySystem& system, std::span<const Bolt> bolts,
             TightenedBolts& found) {
  const auto count = static_cast<Eigen::Index>(bolts.size());
  Eigen::MatrixXd forces(count, count); // of bolt j by shortening bolt k
  Eigen::VectorXd preload(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto number = static_cast<std::size_t>(k);
    preload[k] = bolts[number].force;
    Shares shares(system.size());
    shares[found.body[number]].push_back({1, found.unit[number]});
    const BodySystem alone = strained(system, shares);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(solvable.bound.K.size() + solvable.bound.constraints.rows());
    b.head(system.num_unknowns()) = load_of_strains(alone, solvable.bound);
    StaticSolution one;
    solve(solvable, b, one);
    for (Eigen::Index j = 0; j < count; ++j) {
      const SystemBody& body = alone[found.body[static_cast<std::size_t>(j)]];
      const TrimmedModel& model = body.space->model();
      const FieldSamples fields =
          recover_fields(*body.space, body.material, system.part(one.unknowns, found.body[static_cast<std::size_t>(j)]),
                         model.points.offsets, model.points.parameters);
      forces(j, k) = section_force(*found.unit[static_cast<std::size_t>(j)], model, fields);
    }
    const SystemBody& own = system[found.body[number]];
    const double stiff = own.material.C.maxCoeff() * found.section[number] / own.space->model().grid.span_size()[0];
    if (!(forces(k, k) > free_shank * stiff))
      throw InputError(
          fmt::format("bolt '{}': its shank bears no force when it is shortened, since nothing holds its ends apart; "
                      "check the plane and the normal, and that the shank is tied to what it clamps",
                      bolts[number].name));
  }
  found.shortening = least_squares(forces, preload);
}

void add_bolts(const StaticSettings& settings, const LoadCase& one, const TightenedBolts& bolts,
               const BodySystem& system, StaticSolution& solution) {
  for (std::size_t k = 0; k < settings.bolts.size(); ++k) {
    const std::size_t b = bolts.body[k];
    const TrimmedModel& model = system[b].space->model();
    const FieldSamples& fields = system.size() == 1 ? solution.result.points : solution.bodies[b].points;
    solution.bolts.push_back({settings.bolts[k].name, system.name_among_several(b), settings.bolts[k].force,
                              one.bolts[k], bolts.section[k], bolts.shortening[static_cast<Eigen::Index>(k)],
                              section_force(*bolts.unit[k], model, fields)});
  }
}

// Supports and inertia relief exclude each other.
void need_free_parts(const RunSettings& run) {
  if (!run.supports.empty())
    throw InputError(
        fmt::format("inertia_relief is for parts that nothing holds, but there is support '{}'; leave out one of "
                    "the two",
                    run.supports.front().name));
  if (!run.springs.empty() || !run.masses.empty())
    throw InputError(
        fmt::format("inertia_relief knows nothing of springs and added masses, but there is '{}'; leave out "
                    "one of the two",
                    run.springs.empty() ? run.masses.front().name : run.springs.front().name));
}

} // namespace

StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const SolutionSpace& space) {
  return run_static(run, settings, BodySystem(space, run.material));
}

StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const BodySystem& system) {
  if (settings.cases.size() > 1)
    throw InputError(
        fmt::format("the run has {} load cases ([[case]]); this analysis takes one", settings.cases.size()));
  return std::move(run_static_cases(run, settings, system)[0]);
}

std::vector<StaticSolution> run_static_cases(const RunSettings& run, const StaticSettings& settings,
                                             const BodySystem& system) {
  const std::vector<LoadCase> cases = cases_of(settings);
  std::vector<StaticSolution> solutions(cases.size());
  Timings timings;
  Stopwatch watch(timings);

  if (settings.inertia_relief) need_free_parts(run);
  const std::vector<LocatedProbe> probes = locate_probes(system, settings.probes);
  std::vector<SystemLoad> loads = assemble_loads(system, settings.loads);
  std::vector<std::vector<std::size_t>> load_bodies;
  for (const SystemLoad& load : loads) load_bodies.push_back(load.bodies);
  const ThermalLoad thermal = thermal_load(settings, system);
  TightenedBolts bolts = find_bolts(system, settings.bolts);
  watch.stage("loads");
  BoundSystem bound = bind_system(system, run, watch);
  for (std::size_t k = 0; k < loads.size(); ++k) add_masses(system, bound.masses, settings.loads[k], loads[k]);
  RigidRegions rigid(system, settings.loads, load_bodies, bound.K);
  std::optional<InertiaRelief> relief;
  if (settings.inertia_relief)
    relief.emplace(system, bound.K);
  else
    need_no_free_motion(system, bound);
  watch.stage("supports");
  show_stage(run.progress, "analysis of the matrix");
  SolverReport taken;
  const auto solver = static_solver(run, system, bound, relief ? &*relief : nullptr, !rigid.empty(), taken);
  watch.stage("factorisation");
  show_stage(run.progress, "solution");
  rigid.prepare(*solver);
  const SolvableSystem solvable{bound, rigid, *solver, relief ? &*relief : nullptr};
  if (!settings.bolts.empty()) tighten(solvable, system, settings.bolts, bolts);
  std::vector<CaseLoads> acting;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    StaticSolution& solution = solutions[c];
    acting.push_back(loads_of(cases[c], loads, system));
    solution.case_name = cases[c].name;
    solution.factors = cases[c].factors;
    solution.loads = acting[c].reports;
    solution.system = strained(system, shares_of(cases[c], thermal, bolts, system.size()));
    Eigen::VectorXd f = acting[c].load + load_of_strains(solution.system, bound);
    if (relief) {
      solution.relief = relief->accelerations(f);
      f -= relief->inertia(solution.relief);
    }
    Eigen::VectorXd b(bound.K.size() + bound.constraints.rows());
    b << f + cases[c].prescribed * bound.load, cases[c].prescribed * bound.values;
    solve(solvable, b, solution);
  }
  watch.stage("solution");

  show_stage(run.progress, "fields");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    StaticSolution& solution = solutions[c];
    solution.cost = solver->cost();
    solution.solver = taken;
    solution.regions = bound.regions;
    solution.ties = bound.tie_reports;
    solution.num_constraints = bound.constraints.rows();
    solution.warnings = region_warnings(solution.regions);
    solution.attached = attached_parts(bound);
    for (const std::vector<std::string>& more : {region_warnings(solution.loads), attached_warnings(solution.attached)})
      solution.warnings.insert(solution.warnings.end(), more.begin(), more.end());
    add_temperatures(settings, cases[c], thermal, system, solution);
    recover_bodies(solution.system, solution);
    add_bolts(settings, cases[c], bolts, solution.system, solution);
    for (const LocatedProbe& probe : probes) solution.probe_bodies.push_back(system.name_among_several(probe.body));
    solution.result.probes = recover_probes(solution.system, solution.unknowns, settings.probes, probes);
    solution.result.external_work = 0.5 * acting[c].load.dot(solution.unknowns);
    const PrescribedFactor prescribed(bound, cases[c].prescribed);
    solution.reactions = reactions(solution.system, bound, solution.unknowns, solution.multipliers);
    solution.spring_forces = spring_forces(system, bound.springs, solution.unknowns);
    solution.tie_forces = tie_forces(solution.system, bound.ties, solution.unknowns);
    solution.motions = rigid.motions(solution.unknowns);
    solution.result.penalty_energy = rigid.energy(solution.unknowns) + bound.rigid_masses.energy(solution.unknowns);
    describe_forces(run, settings, system, loads, solution);
  }
  watch.stage("fields");
  show_stage(run.progress, "errors");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    bool known = true;
    for (std::size_t b = 0; relief && b < system.size(); ++b) {
      const auto force = relief->body_force(solutions[c].relief, b);
      known = known && force;
      if (force) acting[c].of_body[b].body_force = sum_of(std::move(acting[c].of_body[b].body_force), *force);
    }
    if (known)
      estimate_error(solutions[c].system, bound, acting[c].of_body, solutions[c]);
    else
      solutions[c].no_energy_error = "pieces of a body move apart";
  }
  watch.stage("errors");
  solutions[0].timings = std::move(timings);
  return solutions;
}

} // namespace iga::solve
