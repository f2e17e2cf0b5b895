#include "solver/explicit/motion/integrator.hpp"

#include "format/model/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

void set_zero(Eigen::VectorXd& x) {
  for_chunks(static_cast<std::size_t>(x.size()), 1 << 13, [&](std::size_t, std::size_t first, std::size_t last) {
    std::fill(x.data() + first, x.data() + last, 0.0);
  });
}

} // namespace

Integrator::Integrator(std::vector<ExplicitBody*> bodies, const IntegratorSettings& settings)
    : bodies_(std::move(bodies)), settings_(settings) {
  if (!(settings.end_time > 0))
    throw InputError(fmt::format("end_time is {:g}: it must be above 0", settings.end_time));
  if (!(settings.safety > 0 && settings.safety <= 1))
    throw InputError(
        fmt::format("the safety factor of the time step is {:g}: above 0 and at most 1 is allowed", settings.safety));
  if (!(settings.start_share > 0 && settings.start_share <= 1))
    throw InputError(fmt::format("the first time step is to be {:g} of its limit: above 0 and at most 1 is allowed",
                                 settings.start_share));
}

void Integrator::prepare(std::vector<StartStep> limits) {
  if (limits.size() != bodies_.size()) throw InputError("there is not one time-step limit for each body");
  limits_ = std::move(limits);
  const std::size_t n = bodies_.size();
  reports_.resize(n);
  external_.resize(n);
  momenta_.resize(n);
  inverted_.assign(n, 0);
  eroded_.assign(n, 0);
  for (std::size_t b = 0; b < n; ++b) {
    const Point3 h = bodies_[b]->space().model().grid.span_size();
    InternalForces& forces = bodies_[b]->forces();
    forces.set_frequency_ratio(limits_[b].omega * std::min({h[0], h[1], h[2]}) / (2 * forces.reference_wave_speed()));
    if (!loads_.empty() || !constraints_.empty()) external_[b].load.resize(bodies_[b]->num_unknowns());
    if (!constraints_.empty()) external_[b].reaction.resize(bodies_[b]->num_unknowns());
    if (!penalties_.empty()) {
      external_[b].penalty.resize(bodies_[b]->num_unknowns());
      external_[b].penalty_sum.resize(bodies_[b]->space().num_nodes());
    }
  }
}

void Integrator::start() {
  std::vector<StartStep> limits;
  for (const ExplicitBody* body : bodies_) limits.push_back(body->start_step());
  start(std::move(limits));
}

void Integrator::start(std::vector<StartStep> limits) {
  clock_.restart();
  prepare(std::move(limits));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const NodeSums sums = momentum_of(*bodies_[b]);
    momenta_[b].linear = momenta_[b].linear_start = sums.linear;
    momenta_[b].angular = momenta_[b].angular_start = sums.angular;
    momenta_[b].linear_scale = sums.linear_scale;
    momenta_[b].angular_scale = sums.angular_scale;
  }
  kick();
  now_.start_energy = energy_.total();
}

void Integrator::step() {
  clock_.restart();
  drift();
  clock_.lap(Phase::Nodes);
  kick();
}

void Integrator::run(const std::function<bool(const Integrator&)>& stop) {
  while (!finished() && !(stop && stop(*this))) step();
}

void Integrator::drift() {
  for (ExplicitBody* body : bodies_) update_displacement(*body, now_.dt_next);
  // The last step was cut so that it ends there.
  now_.time = now_.dt_next >= settings_.end_time - now_.time ? settings_.end_time : now_.time + now_.dt_next;
  now_.dt_last = now_.dt_next;
  ++now_.steps;
}

void Integrator::follow(double limit) {
  StepControl& control = now_.control;
  if (now_.steps == 0) control = {settings_.start_share * limit, settings_.start_share * limit, limit, limit, 0};
  control.least = std::min(control.least, limit);
  if (++control.count >= settings_.hold) {
    control.target = std::max(control.target, std::min(control.least_before, control.least));
    control.least_before = control.least;
    control.least = limit;
    control.count = 0;
  }
  control.target = std::min(control.target, limit);
  control.dt = std::min(control.target, settings_.growth * control.dt);
}

StepTimes Integrator::times() const {
  // x = dt ω_max of the body that limits the step, its own viscous stress included.
  double x = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    x = std::max(x, 2 * now_.dt_next / (limits_[b].dt * reports_[b].step_factor));
  return {now_.time, now_.dt_last, now_.dt_next, std::max(0.0, 4 - x * x), 4 - 4 * settings_.safety * settings_.safety};
}

void Integrator::kick() {
  evaluate_internal();
  clock_.lap(Phase::Internal);
  choose_step();
  clock_.lap(Phase::StepControl);
  evaluate_external();
  clock_.lap(Phase::Loads);
  now_.kinetic = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) kick_body(b);
  clock_.lap(Phase::Nodes);
  balance();
  clock_.lap(Phase::StepControl);
}

void Integrator::evaluate_internal() {
  now_.closed.internal += now_.open.internal;
  now_.closed.load += now_.open.load;
  now_.closed.damping += now_.open.damping;
  now_.closed.viscous += now_.open.viscous;
  now_.open = {};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const ForceReport report = reports_[b] = bodies_[b]->evaluate_forces(now_.dt_last);
    now_.closed.viscous += report.viscous_power * now_.dt_last / 2;
    inverted_[b] += report.inverted;
    eroded_[b] += report.eroded;
    now_.eroded_energy += report.eroded_energy;
    if (report.inverted > 0 && bodies_[b]->settings().stop_at_inverted)
      throw NumericalError(fmt::format("t = {:.6g}: {} points of body '{}' inverted, the first {}; choose another way "
                                       "to treat inverted points, a stiffer law or smaller steps",
                                       now_.time, report.inverted, bodies_[b]->settings().name,
                                       place(b, report.inverted_span)));
  }
}

void Integrator::choose_step() {
  double first = std::numeric_limits<double>::infinity(), dt = first;
  std::size_t limiting = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const double own = settings_.safety * limits_[b].dt * reports_[b].step_factor;
    first = std::min(first, settings_.safety * limits_[b].dt);
    if (own < dt) limiting = b;
    dt = std::min(dt, own);
  }
  if (!(dt >= settings_.floor * first))
    throw NumericalError(fmt::format(
        "t = {:.6g}: the time step fell to {:.3g}, below {:g} of the first one ({:.3g}), for body '{}' {}; smallest "
        "volume ratio there {:.3g}; the material is crushed beyond its law or the contact is too stiff: use a lower "
        "speed, a stiffer material (a yield curve up to full density), smaller spans, or a smaller dt_min to go on",
        now_.time, dt, settings_.floor, first, bodies_[limiting]->settings().name,
        place(limiting, reports_[limiting].step_span), reports_[limiting].min_J));
  if (settings_.largest_dt > 0) dt = std::min(dt, settings_.largest_dt);
  for (const PenaltySource* source : penalties_) {
    if (source->largest_step() < settings_.floor * first && !source->step_reason().empty())
      throw NumericalError(fmt::format("t = {:.6g}: {} and asks for a time step of {:.3g}, below {:g} of the first one "
                                       "({:.3g}): the load is more than the bodies there can stop; use a lower speed, "
                                       "stiffer or thicker material, smaller spans or a smaller dt_min",
                                       now_.time, source->step_reason(), source->largest_step(), settings_.floor,
                                       first));
    dt = std::min(dt, source->largest_step());
  }
  follow(dt);
  dt = now_.control.dt;
  // The last two steps share what is left, so that none is tiny.
  const double left = settings_.end_time - now_.time;
  if (left > 0 && dt >= left * (1 - 1e-9))
    dt = left;
  else if (left > 0 && 2 * dt > left)
    dt = left / 2;
  now_.dt_next = dt;
}

void Integrator::evaluate_external() {
  if (loads_.empty() && penalties_.empty() && constraints_.empty()) return;
  std::vector<BodyState> states(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const ExplicitBody& body = *bodies_[b];
    states[b] = {&body.displacement,   &body.velocity,     body.mass().masses(),
                 body.mass().passes(), &external_[b].load, &external_[b].penalty_sum};
    for (Eigen::VectorXd* sum : {&external_[b].load, &external_[b].penalty, &external_[b].penalty_sum}) set_zero(*sum);
  }
  for (LoadSource* source : loads_) source->add_forces(times(), states);
  for (std::size_t b = 0; b < bodies_.size(); ++b) states[b].force = &external_[b].penalty;
  for (PenaltySource* source : penalties_) {
    const PenaltyEnergy added = source->add_forces(times(), states);
    now_.penalty.stored += added.stored;
    now_.penalty.friction += added.friction;
    now_.penalty.damping += added.damping;
  }
  constrain();
  for (PenaltySource* source : penalties_) source->advance(times());
}

NodeForces Integrator::forces_on(std::size_t b) const {
  NodeForces forces{nullptr, nullptr, now_.dt_last, now_.dt_next};
  if (external_[b].load.size() > 0) forces.load = &external_[b].load;
  if (external_[b].penalty.size() > 0) forces.penalty = &external_[b].penalty;
  return forces;
}

void Integrator::constrain() {
  if (constraints_.empty()) return;
  std::vector<ConstrainedBody> states(bodies_.size());
  for (ConstraintSource* source : constraints_) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const ExplicitBody& body = *bodies_[b];
      External& external = external_[b];
      const double gain = next_velocity(body, forces_on(b), external.next_velocity);
      external.reaction.setZero();
      states[b] = {&body.displacement, &external.next_velocity, &body.mass(), gain, &external.reaction};
    }
    source->add_reactions(times(), states);
    for (External& external : external_) external.load += external.reaction;
  }
}

void Integrator::kick_body(std::size_t b) {
  const NodeSums sums = update_momentum(*bodies_[b], forces_on(b));
  now_.closed.internal += sums.before.internal * now_.dt_last / 2;
  now_.closed.load += sums.before.load * now_.dt_last / 2;
  now_.closed.damping += sums.before.damping * now_.dt_last / 2;
  now_.open.internal += sums.after.internal * now_.dt_next / 2;
  now_.open.load += sums.after.load * now_.dt_next / 2;
  now_.open.damping += sums.after.damping * now_.dt_next / 2;
  now_.open.viscous += reports_[b].viscous_power * now_.dt_next / 2;
  now_.kinetic += sums.kinetic;
  momenta_[b].linear = sums.linear;
  momenta_[b].angular = sums.angular;
  momenta_[b].linear_scale = std::max(momenta_[b].linear_scale, sums.linear_scale);
  momenta_[b].angular_scale = std::max(momenta_[b].angular_scale, sums.angular_scale);
  momenta_[b].linear_impulse += sums.linear_impulse;
  momenta_[b].angular_impulse += sums.angular_impulse;
}

void Integrator::balance() {
  energy_.internal = now_.closed.internal - now_.closed.viscous - now_.eroded_energy;
  energy_.kinetic = now_.kinetic;
  energy_.contact = now_.penalty.stored;
  energy_.friction = now_.penalty.friction;
  energy_.damping = now_.closed.damping + now_.closed.viscous + now_.penalty.damping;
  energy_.external = now_.closed.load;
  energy_.eroded = now_.eroded_energy;
  for (const PenaltySource* source : penalties_) {
    energy_.kinetic += source->kinetic_energy();
    energy_.external += source->external_work();
  }
  now_.largest_energy = std::max(now_.largest_energy, energy_.scale());
  std::size_t worst = 0; // body
  for (std::size_t b = 1; b < bodies_.size(); ++b)
    if (reports_[b].min_J < reports_[worst].min_J) worst = b;
  const auto likely = [&] {
    return fmt::format("smallest volume ratio {:.3g} in body '{}' {}", reports_[worst].min_J,
                       bodies_[worst]->settings().name, place(worst, reports_[worst].min_J_span));
  };
  if (!std::isfinite(energy_.total()))
    throw NumericalError(fmt::format("t = {:.6g}, step {}: the motion is no longer finite; {}; use a smaller safety "
                                     "factor of the time step",
                                     now_.time, now_.steps, likely()));
  if (settings_.energy_limit > 0 && now_.steps > 0 && energy_error() > settings_.energy_limit)
    throw NumericalError(fmt::format("t = {:.6g}, step {}: the energy balance is off by {:.3g} of the largest energy, "
                                     "at most {:g} is allowed; {}; use a smaller safety factor of the time step",
                                     now_.time, now_.steps, energy_error(), settings_.energy_limit, likely()));
}

double Integrator::energy_error() const {
  if (!(now_.largest_energy > 0)) return 0;
  const double lost_or_made = std::abs(energy_.total() - now_.start_energy);
  return std::max(lost_or_made, energy_.total_without_debt() - now_.start_energy) / now_.largest_energy;
}

std::string Integrator::place(std::size_t b, std::int32_t span) const {
  if (span < 0) return "at rest";
  const TrimmedModel& model = bodies_[b]->space().model();
  const Index3 ijk = model.grid.span_index(model.cells.span[static_cast<std::size_t>(span)]);
  const Box3 box = model.grid.span_box(ijk);
  Point3 u{};
  for (std::size_t d = 0; d < 3; ++d) u[d] = (box.lower[d] + box.upper[d]) / 2;
  const Point3 x = model.grid.to_position(u);
  return fmt::format("in span ({}, {}, {}) near ({:.6g}, {:.6g}, {:.6g})", ijk[0], ijk[1], ijk[2], x[0], x[1], x[2]);
}

namespace {

constexpr const char* other_run = "the state is that of another run; restart with the files that the run began with";

std::vector<double> numbers(const Eigen::VectorXd& x) {
  return {x.data(), x.data() + x.size()};
}

void restore(const std::string& name, const std::vector<double>& from, Eigen::VectorXd& to) {
  if (static_cast<Eigen::Index>(from.size()) != to.size())
    throw InputError(fmt::format("{}: found {} numbers, expected {}; {}", name, from.size(), to.size(), other_run));
  to = Eigen::Map<const Eigen::VectorXd>(from.data(), to.size());
}

void check_layout(const SavedArray& found, const SavedArray& expected) {
  if (found.name != expected.name)
    throw InputError(fmt::format("{}: found in the place of {}; {}", found.name, expected.name, other_run));
  const std::size_t n = found.values.size();
  if (expected.columns > 0 ? n % expected.columns != 0 : n != expected.values.size())
    throw InputError(fmt::format("{}: found {} numbers, expected {}{}; {}", found.name, n,
                                 expected.columns > 0 ? "rows of " : "",
                                 expected.columns > 0 ? expected.columns : expected.values.size(), other_run));
}

template <class Visit> void for_vectors(MomentumBalance& m, Visit visit) {
  for (Eigen::Vector3d* v :
       {&m.linear, &m.angular, &m.linear_impulse, &m.angular_impulse, &m.linear_start, &m.angular_start})
    visit(*v);
}

} // namespace

IntegratorState Integrator::save() const {
  IntegratorState state;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const ExplicitBody& body = *bodies_[b];
    IntegratorState::Body saved{body.settings().name,
                                numbers(body.displacement),
                                numbers(body.velocity),
                                numbers(body.momentum),
                                body.forces().save(),
                                {},
                                reports_[b],
                                inverted_[b],
                                eroded_[b]};
    MomentumBalance momentum = momenta_[b];
    std::size_t k = 0;
    for_vectors(momentum, [&](const Eigen::Vector3d& v) {
      for (Eigen::Index d = 0; d < 3; ++d) saved.momenta[k++] = v[d];
    });
    saved.momenta[k++] = momentum.linear_scale;
    saved.momenta[k++] = momentum.angular_scale;
    state.bodies.push_back(std::move(saved));
  }
  for (const PenaltySource* source : penalties_)
    for (SavedArray& array : source->save()) state.sources.push_back(std::move(array));
  state.progress = now_;
  return state;
}

void Integrator::load(const IntegratorState& state, std::vector<StartStep> limits) {
  prepare(std::move(limits));
  if (state.bodies.size() != bodies_.size())
    throw InputError(fmt::format("bodies: found {}, expected {}; {}", state.bodies.size(), bodies_.size(), other_run));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const IntegratorState::Body& saved = state.bodies[b];
    const std::string& name = bodies_[b]->settings().name;
    if (saved.name != name)
      throw InputError(fmt::format("bodies: found '{}' in the place of '{}'; {}", saved.name, name, other_run));
    restore(fmt::format("bodies/{}/displacement", name), saved.displacement, bodies_[b]->displacement);
    restore(fmt::format("bodies/{}/velocity", name), saved.velocity, bodies_[b]->velocity);
    restore(fmt::format("bodies/{}/momentum", name), saved.momentum, bodies_[b]->momentum);
    try {
      bodies_[b]->forces().load(saved.points);
    } catch (const InputError& error) {
      throw InputError(fmt::format("bodies/{}/{}", name, error.what()));
    }
    std::size_t k = 0;
    for_vectors(momenta_[b], [&](Eigen::Vector3d& v) {
      for (Eigen::Index d = 0; d < 3; ++d) v[d] = saved.momenta[k++];
    });
    momenta_[b].linear_scale = saved.momenta[k++];
    momenta_[b].angular_scale = saved.momenta[k++];
    reports_[b] = saved.report;
    inverted_[b] = saved.inverted;
    eroded_[b] = saved.eroded;
  }
  load_sources(state.sources);
  now_ = state.progress;
  balance();
}

void Integrator::load_sources(std::span<const SavedArray> saved) {
  for (PenaltySource* source : penalties_) {
    const std::vector<SavedArray> expected = source->save();
    for (std::size_t k = 0; k < expected.size(); ++k) {
      if (k == saved.size())
        throw InputError(fmt::format("{}: is missing, expected {} numbers; {}", expected[k].name,
                                     expected[k].values.size(), other_run));
      check_layout(saved[k], expected[k]);
    }
    source->load(saved.first(expected.size()));
    saved = saved.subspan(expected.size());
  }
  if (!saved.empty())
    throw InputError(fmt::format("{}: found, but nothing in this run has it; {}", saved.front().name, other_run));
}

} // namespace iga::solve
