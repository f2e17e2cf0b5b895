// Central differences in time: several bodies, one step for all, and the accounts of energy and momentum.
#pragma once

#include "solver/base/phase_clock.hpp"
#include "solver/explicit/motion/energy_balance.hpp"
#include "solver/explicit/motion/explicit_body.hpp"
#include "solver/explicit/motion/force_source.hpp"
#include "solver/explicit/motion/node_update.hpp"

namespace iga::solve {

struct IntegratorSettings {
  double end_time = 0;
  double safety = 0.9;   ///< of the critical step; 0.67 for violent crushing
  double largest_dt = 0; ///< 0: no other limit than stability
  /// A step that follows each oscillation of the body adds energy to it. So it shrinks at once where it must, and
  /// grows only to what has been allowed throughout this many steps, at most by `growth` from one to the next.
  int hold = 200;
  double growth = 1.02;
  /// The first steps are this share of the limit, and grow as after a hold. Below 1 for bodies that start with a strong
  /// vibration: a first step that has to shrink in the first compression gives energy to the fastest modes, see README.
  double start_share = 1;
  double floor = 1e-4;        ///< a step below this share of the first one ends the run
  double energy_limit = 0;    ///< relative error of the energy balance that ends the run; 0: none does
  std::int64_t max_steps = 0; ///< 0: as many as it takes
};

/// Works of forces along the way of the bodies, trapezoidal: half of f_n with the way to t_n, half with the way from
/// it.
struct Works {
  double internal = 0, load = 0, damping = 0, viscous = 0;
};

/// The step as stability alone would have it: what was allowed lately.
struct StepControl {
  double dt = 0;                      ///< now
  double target = 0;                  ///< what it may grow to
  double least_before = 0, least = 0; ///< limit of the last complete window of steps, and of the one that runs
  std::int64_t count = 0;             ///< steps of that one
};

/// Time, step, energies and momenta of a run.
struct Progress {
  double time = 0, dt_last = 0, dt_next = 0;
  double kinetic = 0; ///< of the bodies
  StepControl control;
  std::int64_t steps = 0;
  Works closed, open; ///< up to t_n; the first halves of the interval after it
  PenaltyEnergy penalty;
  double eroded_energy = 0, start_energy = 0, largest_energy = 0;
};

/// Everything that changes in a run, as plain numbers: a run that loads it goes on bit for bit.
struct IntegratorState {
  struct Body {
    std::string name;
    std::vector<double> displacement, velocity, momentum;
    PointHistory points;
    std::array<double, 20> momenta{}; ///< MomentumBalance
    ForceReport report;
    std::int64_t inverted = 0, eroded = 0;
  };
  std::vector<Body> bodies;
  std::vector<SavedArray> sources; ///< one after the other
  Progress progress;
};

/// One step: u_n = u_{n-1} + dt v_{n-1/2}; forces at t_n; dt of the next step; p_{n+1/2} = p_{n-1/2} + dt_n (f_ext -
/// f_int), dt_n the mean of the steps before and after; v = M⁻¹ p. Between steps all is known at t_n, and velocities
/// and momenta half a step later.
class Integrator {
 public:
  /// Bodies and sources must outlive it; set initial velocities before.
  Integrator(std::vector<ExplicitBody*> bodies, const IntegratorSettings& settings);

  void add(PenaltySource& source) { penalties_.push_back(&source); }
  void add(LoadSource& source) { loads_.push_back(&source); }
  void add(ConstraintSource& source) { constraints_.push_back(&source); }

  /// The limits of the bodies at rest, and the forces and half step at t = 0. Limits may be given where they are known.
  /// @throws NumericalError as ExplicitBody::start_step and step
  void start();
  void start(std::vector<StartStep> limits);
  /// In the place of start: takes over a saved state; limits as saved by limits().
  /// @throws InputError where it is not that of these bodies and sources: which array, found, expected
  void load(const IntegratorState& state, std::vector<StartStep> limits);
  IntegratorState save() const;

  bool finished() const {
    return now_.time >= settings_.end_time || (settings_.max_steps > 0 && now_.steps >= settings_.max_steps);
  }
  /// @throws NumericalError where the run blew up (NaN), the step fell below the floor, a point inverted that must not,
  /// or the energy is lost, with time, place and what to do
  void step();
  /// Steps until the end or until stop(*this) holds.
  void run(const std::function<bool(const Integrator&)>& stop = {});

  double time() const { return now_.time; }
  double dt() const { return now_.dt_next; } ///< of the step to come
  std::int64_t steps() const { return now_.steps; }
  const std::vector<StartStep>& limits() const { return limits_; }
  const EnergyBalance& energy() const { return energy_; }
  /// |total - that of the start| / the largest of internal, kinetic and external energy so far; the total without
  /// EnergyBalance's debt of contact where that is farther above.
  double energy_error() const;
  double largest_energy() const { return now_.largest_energy; } ///< internal, kinetic or external, so far
  /// Of an active span of a body, for messages; "at rest" for -1.
  std::string place(std::size_t body, std::int32_t span) const;
  const MomentumBalance& momentum(std::size_t body) const { return momenta_[body]; }
  const ForceReport& report(std::size_t body) const { return reports_[body]; }
  const std::vector<ExplicitBody*>& bodies() const { return bodies_; }
  /// Where the time of the steps went; sources and the loop around the steps may take laps of their own.
  PhaseClock& clock() { return clock_; }
  const PhaseClock& clock() const { return clock_; }
  /// Points that inverted, evaluation by evaluation, and points taken out so far.
  std::int64_t inverted(std::size_t body) const { return inverted_[body]; }
  std::int64_t eroded(std::size_t body) const { return eroded_[body]; }

 private:
  void prepare(std::vector<StartStep> limits);
  void drift();
  void kick();
  void evaluate_internal();
  void choose_step();
  void follow(double limit);
  StepTimes times() const;
  void evaluate_external();
  NodeForces forces_on(std::size_t b) const;
  void constrain();
  void kick_body(std::size_t b);
  void balance();
  void load_sources(std::span<const SavedArray> saved);

  struct External { // on one body; empty vectors where nothing acts
    Eigen::VectorXd load, penalty, penalty_sum;
    Eigen::VectorXd next_velocity, reaction; // with constraints
  };

  std::vector<ExplicitBody*> bodies_;
  IntegratorSettings settings_;
  std::vector<PenaltySource*> penalties_;
  std::vector<LoadSource*> loads_;
  std::vector<ConstraintSource*> constraints_;
  std::vector<StartStep> limits_;
  std::vector<ForceReport> reports_;
  std::vector<External> external_;
  std::vector<MomentumBalance> momenta_;
  std::vector<std::int64_t> inverted_, eroded_;
  Progress now_;
  EnergyBalance energy_;
  PhaseClock clock_;
};

} // namespace iga::solve
