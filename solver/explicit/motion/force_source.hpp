// What acts on bodies from outside: loads, supports, contact with its rigid bodies, constraints of the velocity.
//
// Order of a step, all at t_n: internal forces; the next dt; LoadSource; PenaltySource; ConstraintSource, which sees
// the velocity v_{n+1/2} that all of these lead to; then the bodies take their velocities.
#pragma once

#include "solver/explicit/motion/contact_body.hpp"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace iga::solve {

class MassOperator;

/// Numbers that a source keeps for a restart, under the name that they have in the restart file.
struct SavedArray {
  std::string name;           ///< "contact/numbers": groups and dataset, without two of the same name in a run
  std::vector<double> values; ///< (rows × columns)
  std::size_t columns = 0;    ///< any number of rows of so many numbers; 0: the length is that of the source
  bool operator==(const SavedArray&) const = default;
};

/// Forces of springs that belong to no body: contact, supports by penalty. They keep account of their own energy.
class PenaltySource {
 public:
  virtual ~PenaltySource() = default;
  /// Adds the forces at t_n to each body's force, in the order of the bodies, and its stiffness to penalty_sum, within
  /// the budget of the step: times.budget minus what penalty_sum holds already.
  virtual PenaltyEnergy add_forces(const StepTimes& times, std::span<const BodyState> bodies) = 0;
  /// The step it wants to work with, whatever stability allows.
  virtual double largest_step() const { return std::numeric_limits<double>::infinity(); }
  /// Why that step, for a message; empty where it has asked for it since the start.
  virtual std::string step_reason() const { return {}; }
  /// Moves what it owns (rigid bodies) from t_n to t_{n+1}; called when all sources have added their forces at t_n.
  virtual void advance(const StepTimes&) {}
  /// Of what it owns, at the t_n of the last advance.
  virtual double kinetic_energy() const { return 0; }
  /// Work of its drives since the start of the run, up to that t_n.
  virtual double external_work() const { return 0; }
  /// All that changes, for a restart. Names and lengths are the same at any time, before the first step too.
  virtual std::vector<SavedArray> save() const { return {}; }
  /// @pre the names of save() in its order, each with its length
  virtual void load(std::span<const SavedArray>) {}
};

/// Forces that are given, whatever hangs on them: tractions, pressures, point loads. The integrator sums their work.
class LoadSource {
 public:
  virtual ~LoadSource() = default;
  /// Adds the forces at t_n; penalty_sum is not touched.
  virtual void add_forces(const StepTimes& times, std::span<const BodyState> bodies) = 0;
};

/// A body whose next velocity is known, but for constraints. All vectors (3 num_nodes), component fastest.
struct ConstrainedBody {
  const Eigen::VectorXd* displacement = nullptr; ///< u at t_n
  const Eigen::VectorXd* velocity = nullptr;     ///< v_{n+1/2} without this constraint; those before it have acted
  const MassOperator* mass = nullptr;
  double gain = 0;                     ///< time: a force f at t_n adds gain M⁻¹ f to that velocity
  Eigen::VectorXd* reaction = nullptr; ///< zero; the force that the constraint puts on the nodes at t_n is added here
};

/// Rules that velocities obey exactly: regions that move as given, by lumped projection. No stiffness, so the time step
/// does not feel them. What they do counts as a load: the trapezoidal work of the reaction is external work.
class ConstraintSource {
 public:
  virtual ~ConstraintSource() = default;
  /// Called once per step after all forces, in the order of the bodies. The body moves on with
  /// v_{n+1/2} = velocity + gain M⁻¹ reaction and u_{n+1} = u_n + times.dt v_{n+1/2}: to stand at u_D(t_{n+1}) ask for
  /// the velocity (u_D(t_{n+1}) - u_n) / times.dt, which does not drift. In the first evaluation of a run
  /// times.dt_last is 0 and gain half of what it is later. Same bits for any number of threads. Where two constraints
  /// act on the same nodes the one added last holds exactly.
  virtual void add_reactions(const StepTimes& times, std::span<const ConstrainedBody> bodies) = 0;
};

} // namespace iga::solve
