// What acts on bodies from outside: loads, supports, contact with its rigid bodies.
#pragma once

#include "solver/explicit/contact_body.hpp"

#include <span>

namespace iga::solve {

/// Forces of springs that belong to no body: contact, supports by penalty. They keep their own books.
class PenaltySource {
 public:
  virtual ~PenaltySource() = default;
  /// Adds the forces at t_n to each body's force, in the order of the bodies, and its stiffness to penalty_sum, within
  /// the budget of the step: times.budget minus what penalty_sum holds already.
  virtual PenaltyEnergy add_forces(const StepTimes& times, std::span<const BodyState> bodies) = 0;
  /// Moves what it owns (rigid bodies) from t_n to t_{n+1}; called when all sources have added their forces at t_n.
  virtual void advance(const StepTimes&) {}
  /// Of what it owns, at the t_n of the last advance.
  virtual double kinetic_energy() const { return 0; }
  /// Work of its drives since the start of the run, up to that t_n.
  virtual double external_work() const { return 0; }
  /// All that changes, for a restart.
  virtual std::vector<double> save() const { return {}; }
  virtual void load(std::span<const double>) {}
};

/// Forces that are given, whatever hangs on them: tractions, pressures, point loads. The integrator books their work.
class LoadSource {
 public:
  virtual ~LoadSource() = default;
  /// Adds the forces at t_n; penalty_sum is not touched.
  virtual void add_forces(const StepTimes& times, std::span<const BodyState> bodies) = 0;
};

} // namespace iga::solve
