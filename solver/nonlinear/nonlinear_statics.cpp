#include "solver/nonlinear/nonlinear_statics.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/linalg/linear_solver.hpp"
#include "solver/linalg/unsymmetric_solver.hpp"
#include "solver/mechanics/body_system.hpp"
#include "solver/supports/support_check.hpp"
#include "solver/supports/support_rows.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace iga::solve {

namespace {

// A Newton step is taken whole where the residual along it falls to this share at least.
constexpr double enough = 0.8;
constexpr int most_searches = 5;
// A step that converged within so many iterations lets the next one grow.
constexpr int easy = 6;
constexpr double growth = 1.5;

void need_flat(const PreparedSupport& prepared) {
  const SurfaceRegion& region = prepared.region;
  Point3 sum{};
  double area = 0;
  for (std::size_t q = 0; q < region.weights.size(); ++q) {
    sum = plus(sum, times(region.normals[q], region.weights[q]));
    area += region.weights[q];
  }
  constexpr double flat = 1e-6; // of facets written with single precision
  if (norm(sum) < (1 - flat) * area)
    throw InputError(fmt::format("support '{}': its surface is not flat: at large displacement the part slides away "
                                 "from the normals of its undeformed surface; fix components there",
                                 prepared.support.name));
}

} // namespace

NonlinearStatics::NonlinearStatics(const NonlinearRun& run, const SolutionSpace& space)
    : space_(&space), settings_(run.newton), small_strain_(small_strain(run.material.law)),
      connectivity_(std::make_shared<const Connectivity>(space)),
      body_(std::make_unique<FiniteBody>(space, run.material.law, connectivity_, run.locking)), holding_(connectivity_),
      probes_(run.probes), places_(locate_probes(space.model(), run.probes)) {
  // A unit in the last place of F, taken as stress on a face of a span, at every node: small loads on nearly
  // incompressible parts leave no more of the residual.
  const Point3 h = space.model().grid.span_size();
  const double face = h[0] * h[1] * h[2] / std::ranges::min(h);
  stress_rounding_ = 2 * std::numeric_limits<double>::epsilon() * small_strain_.C(0, 0) * face *
                     std::sqrt(static_cast<double>(space.num_unknowns()));
  add_loads(run);
  add_supports(run);
  add_contacts(run);
  need_held(run);
  state_.increment = 1.0 / settings_.steps;
  state_.u = Eigen::VectorXd::Zero(space.num_unknowns());
  tangent_ = make_tangent();
}

void NonlinearStatics::add_loads(const NonlinearRun& run) {
  dead_ = Eigen::VectorXd::Zero(space_->num_unknowns());
  for (const NonlinearLoad& load : run.loads) {
    LoadTerms terms = assemble_loads(*space_, small_strain_.density, std::span(&load.load, 1));
    if (load.follower)
      pressures_.emplace_back(*space_, std::move(terms.surfaces[0].region), load.load.pressure);
    else
      dead_ += terms.load;
    load_reports_.push_back(std::move(terms.reports[0]));
  }
  warnings_ = region_warnings(load_reports_);
}

void NonlinearStatics::add_supports(const NonlinearRun& run) {
  supports_ = apply_supports(*space_, small_strain_, run.supports, holding_);
  for (const PreparedSupport& prepared : supports_.prepared)
    if (prepared.support.along_normal) need_flat(prepared);
  const std::vector<std::string> of_regions = region_warnings(supports_.regions);
  warnings_.insert(warnings_.end(), of_regions.begin(), of_regions.end());
}

void NonlinearStatics::add_contacts(const NonlinearRun& run) {
  const double modulus = penalty_stiffness(*space_, small_strain_, Extent::Surface);
  for (const ToolContactSettings& contact : run.contacts) {
    contacts_.emplace_back(*space_, contact, run.rigid[contact.tool].body, modulus);
    contact_reports_.emplace_back();
  }
}

// What touches a tool before the first step is held like by a foundation.
void NonlinearStatics::need_held(const NonlinearRun& run) const {
  const BodySystem system(*space_, small_strain_);
  std::vector<PreparedSpring> touching;
  for (const ToolContact& contact : contacts_) {
    PreparedSpring spring;
    spring.spring.normal = 1;
    spring.spring.tangential = contact.settings().rough || contact.settings().friction > 0 ? 1 : 0;
    spring.region = contact.touching();
    touching.push_back(std::move(spring));
  }
  const std::vector<std::string> free =
      free_rigid_motions(system, connectivity_->pattern, std::span(&supports_, 1), touching);
  if (free.empty()) return;
  throw InputError(fmt::format("{}{}: statics need supports that resist every rigid motion:\n  {}\n"
                               "add a [[support]] or fix more components{}",
                               run.supports.empty() ? "no support is given" : "the supports do not hold the part",
                               contacts_.empty() ? "" : ", nor do the tools that it touches at the start",
                               fmt::join(free, "\n  "),
                               contacts_.empty() ? "" : ", or place the tools so that they touch it"));
}

Tangent NonlinearStatics::make_tangent() const {
  return Tangent(connectivity_,
                 body_->law().is_symmetric() && pressures_.empty() &&
                     std::ranges::all_of(contacts_, [](const ToolContact& contact) { return contact.is_symmetric(); }));
}

NonlinearStatics::Residual NonlinearStatics::residual(const Eigen::VectorXd& u, double factor) const {
  Residual found;
  found.internal = Eigen::VectorXd::Zero(u.size());
  found.points = body_->add_forces(u, found.internal);
  Eigen::VectorXd loads = factor * dead_;
  for (const FollowerPressure& pressure : pressures_) pressure.add_forces(u, factor, loads);
  const Eigen::VectorXd pull = holding_ * u, held = factor * supports_.load - pull;
  Eigen::VectorXd touched = Eigen::VectorXd::Zero(u.size());
  for (const ToolContact& contact : contacts_) contact.add_forces(u, factor, touched);
  found.external = loads + held;
  found.r = found.external + touched - found.internal;
  found.size = std::max({loads.norm(), held.norm(), touched.norm(), found.internal.norm()});
  found.rounding = 64 * std::numeric_limits<double>::epsilon() * (pull.norm() + found.size) + stress_rounding_;
  return found;
}

void NonlinearStatics::tangent(const Eigen::VectorXd& u, double factor, Tangent& A) const {
  std::copy(holding_.values().begin(), holding_.values().end(), A.lower.values().begin());
  if (!A.symmetric) std::copy(holding_.values().begin(), holding_.values().end(), A.upper.values().begin());
  body_->add_tangent(u, A);
  for (const FollowerPressure& pressure : pressures_) pressure.subtract_stiffness(u, factor, A);
  for (const ToolContact& contact : contacts_) contact.subtract_stiffness(u, factor, A);
}

Eigen::VectorXd NonlinearStatics::solve(const Eigen::VectorXd& r, StepReport& report) const {
  report.symmetric = tangent_.symmetric;
  if (!tangent_.symmetric) return factorise_unsymmetric(tangent_.lower, tangent_.upper)->solve(r);
  SystemMatrix system;
  system.stiffness = &tangent_.lower;
  try {
    const auto solver = factorise_positive_definite(system);
    report.definite = true;
    return solver->solve(r);
  } catch (const NumericalError&) { // past a limit point, or far from equilibrium
    report.definite = false;
    return factorise_indefinite(system)->solve(r);
  }
}

bool NonlinearStatics::equilibrate(double factor, bool search, Eigen::VectorXd& u, StepReport& report,
                                   const std::function<void(const std::string&)>& show) {
  Residual now = residual(u, factor);
  for (int iteration = 1; iteration <= settings_.max_iterations; ++iteration) {
    io::stop_if_interrupted();
    tangent(u, factor, tangent_);
    Eigen::VectorXd step;
    try {
      step = solve(now.r, report);
    } catch (const NumericalError&) {
      return false;
    }
    ++report.iterations;
    if (!step.allFinite()) return false;
    // Along the step: r · step falls from its first value through zero where the energy is least.
    const double first = now.r.dot(step);
    double share = 1, best_share = 0, best_slope = std::numeric_limits<double>::infinity();
    Residual best;
    for (int attempt = 0; attempt < most_searches; ++attempt) {
      Residual tried = residual(u + share * step, factor);
      const double slope = tried.r.dot(step);
      const bool sound = std::isfinite(slope) && tried.points.inverted <= now.points.inverted;
      if (sound && std::abs(slope) < best_slope) {
        best_slope = std::abs(slope);
        best_share = share;
        best = std::move(tried);
      }
      if (sound &&
          (!search || std::abs(slope) <= enough * std::abs(first) || best.r.norm() <= settings_.tolerance * best.size))
        break;
      const double root = sound && slope != first ? share * first / (first - slope) : 0;
      share = root > 0.1 * share && root < 0.9 * share ? root : 0.5 * share;
    }
    if (best_share == 0) return false;
    u += best_share * step;
    now = std::move(best);
    report.residual = now.size > 0 ? now.r.norm() / now.size : 0;
    report.residuals.push_back(report.residual);
    report.points = now.points;
    if (show)
      show(fmt::format("load factor {:.5g}, iteration {}: residual {:.1e}", factor, iteration, report.residual));
    if (now.r.norm() <= std::max(settings_.tolerance * now.size, now.rounding)) return true;
  }
  return false;
}

StepReport NonlinearStatics::advance(double target, const std::function<void(const std::string&)>& show) {
  StepReport all;
  std::string lost;
  constexpr double last_bit = 1e-12;
  while (state_.factor < target - last_bit) {
    const double largest = 1.0 / settings_.steps;
    const bool to_the_end = state_.factor + state_.increment * (1 + 1e-6) >= target;
    const double factor = to_the_end ? target : state_.factor + state_.increment;
    Eigen::VectorXd u = state_.u;
    StepReport report;
    // Whole steps first: in slender parts they stretch and then relax, which a search along each would stop at once.
    bool found = equilibrate(factor, false, u, report, show);
    if (!found) {
      u = state_.u;
      const int spent = report.iterations;
      report = {};
      report.iterations = spent;
      found = equilibrate(factor, true, u, report, show);
    }
    if (found) {
      lost.clear();
      for (const ToolContact& contact : contacts_)
        if (lost.empty()) lost = contact.too_far(u, factor);
      found = lost.empty();
    }
    if (found) {
      const Eigen::VectorXd moved = u - state_.u;
      const Residual before = residual(state_.u, state_.factor), after = residual(u, factor);
      state_.work += 0.5 * (before.internal + after.internal).dot(moved);
      state_.external += 0.5 * (before.external + after.external).dot(moved);
      for (std::size_t c = 0; c < contacts_.size(); ++c) contact_reports_[c] = contacts_[c].keep(u, factor);
      report.contacts = contact_reports_;
      body_->keep(u);
      state_.u = std::move(u);
      state_.factor = factor;
      if (report.iterations <= easy) state_.increment = std::min(growth * state_.increment, largest);
    } else {
      ++all.cuts;
      state_.increment = 0.5 * (factor - state_.factor);
      if (state_.increment < settings_.smallest_step * largest)
        throw NumericalError(fmt::format(
            "no equilibrium was found beyond the load factor {:.6g}: steps down to {:.2g} of a load step did not "
            "converge{}{}",
            state_.factor, settings_.smallest_step, lost.empty() ? "" : "; " + lost,
            report.definite ? "" : "; the stiffness is no longer positive definite: the part buckles or gives way"));
    }
    const int iterations = all.iterations + report.iterations, cuts = all.cuts;
    if (state_.factor == factor) all = report;
    all.iterations = iterations;
    all.cuts = cuts;
    all.factor = state_.factor;
  }
  return all;
}

std::vector<SupportForce> NonlinearStatics::support_forces() const {
  SupportTerms scaled = supports_;
  for (PreparedSupport& prepared : scaled.prepared) {
    prepared.support.value = times(prepared.support.value, state_.factor);
    for (Point3& row : prepared.support.gradient) row = times(row, state_.factor);
  }
  std::vector<SupportForce> forces;
  const auto all = reactions(*space_, small_strain_, scaled, state_.u, Eigen::VectorXd());
  for (std::size_t s = 0; s < all.size(); ++s) {
    const PreparedSupport& prepared = scaled.prepared[s];
    SupportForce force{all[s].name, all[s].force, all[s].moment, 0};
    if (prepared.region.report.extent == Extent::Surface && !prepared.beta.empty())
      force.gap = std::sqrt(2 * all[s].penalty_energy / (prepared.beta[0] * prepared.region.report.area));
    forces.push_back(std::move(force));
  }
  return forces;
}

std::vector<Point3> NonlinearStatics::probe_displacements() const {
  std::vector<Point3> all;
  SpanShapes shapes;
  for (const LocatedPoint& place : places_) {
    evaluate(*space_, place.cell, place.parameter, Shapes::Values, shapes);
    const auto nodes = space_->nodes(place.cell);
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      u +=
          shapes.values(0, static_cast<Eigen::Index>(i)) * state_.u.segment<3>(3 * static_cast<Eigen::Index>(nodes[i]));
    all.push_back(as_point(u));
  }
  return all;
}

Point3 NonlinearStatics::load_force() const {
  Eigen::VectorXd ignored = Eigen::VectorXd::Zero(state_.u.size());
  Point3 sum{};
  for (const FollowerPressure& pressure : pressures_)
    sum = plus(sum, pressure.add_forces(state_.u, state_.factor, ignored));
  for (Eigen::Index i = 0; i < dead_.size(); ++i) sum[static_cast<std::size_t>(i % 3)] += state_.factor * dead_[i];
  return sum;
}

double NonlinearStatics::external_work() const {
  double sum = state_.external;
  for (const ToolContact& contact : contacts_) sum += contact.tool_work();
  return sum;
}

double NonlinearStatics::contact_energy() const {
  double sum = 0;
  for (const ToolContactReport& report : contact_reports_) sum += report.stored;
  return sum;
}

double NonlinearStatics::friction_energy() const {
  double sum = 0;
  for (const ToolContact& contact : contacts_) sum += contact.dissipated();
  return sum;
}

StaticState NonlinearStatics::save() const {
  StaticState state = state_;
  for (const ToolContact& contact : contacts_) {
    const std::vector<double> numbers = contact.save();
    state.contacts.insert(state.contacts.end(), numbers.begin(), numbers.end());
  }
  state.points = body_->save();
  return state;
}

void NonlinearStatics::load(const StaticState& state) {
  if (state.u.size() != state_.u.size())
    throw InputError(fmt::format("displacement: found {} numbers, expected {}; the state is that of another model",
                                 state.u.size(), state_.u.size()));
  body_->load(state.points);
  std::size_t first = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const std::size_t count = contacts_[c].save().size();
    if (first + count > state.contacts.size())
      throw InputError("contacts: found too few numbers; the state is that of another model");
    contacts_[c].load({state.contacts.begin() + static_cast<std::ptrdiff_t>(first),
                       state.contacts.begin() + static_cast<std::ptrdiff_t>(first + count)},
                      state.u, state.factor);
    Eigen::VectorXd ignored = Eigen::VectorXd::Zero(state.u.size());
    contact_reports_[c] = contacts_[c].add_forces(state.u, state.factor, ignored);
    first += count;
  }
  state_ = state;
  state_.points = {};
  state_.contacts.clear();
  state_.increment = std::min(state.increment, 1.0 / settings_.steps);
}

} // namespace iga::solve
