// What a run has to keep: energy and momentum.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>

namespace iga::solve {

/// At one time t_n, since the start of the run; force · length. The order is that of TimeSeries::energy_names.
struct EnergyBalance {
  double internal = 0; ///< work against internal forces, plastic work included, viscous one and eroded points not
  double kinetic = 0;  ///< see NodeSums::kinetic; rigid bodies included
  double contact = 0;  ///< in contact springs
  double friction = 0;
  double damping = 0;  ///< dissipated: mass-proportional, viscous stress, bulk viscosity, contact damping
  double external = 0; ///< work of loads, gravity and driven bodies
  double eroded = 0;   ///< energy that points held when they were taken out

  std::array<double, 7> values() const { return {internal, kinetic, contact, friction, damping, external, eroded}; }
  /// internal + … - external; what a run should keep.
  double total() const { return internal + kinetic + contact + friction + damping + eroded - external; }
  /// The same with contact counted while it stores only: springs that have given back more than they took have made
  /// energy, which total() does not see because it stands in internal and kinetic energy by then.
  double total_without_debt() const { return total() - std::min(contact, 0.0); }
  double scale() const { return std::max({std::abs(internal), std::abs(kinetic), std::abs(external)}); }
};

/// Momentum of one body at t_{n+1/2} and what external forces gave it since the start; angular about the origin.
struct MomentumBalance {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();         ///< mass · length/time
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();        ///< mass · length²/time
  Eigen::Vector3d linear_impulse = Eigen::Vector3d::Zero(); ///< loads, contact, damping; force · time
  Eigen::Vector3d angular_impulse = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear_start = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_start = Eigen::Vector3d::Zero();

  double linear_scale = 0, angular_scale = 0; ///< largest Σ |p_i| and Σ |x_i × p_i| of the nodes so far

  Eigen::Vector3d linear_error() const { return linear - linear_start - linear_impulse; }
  Eigen::Vector3d angular_error() const { return angular - angular_start - angular_impulse; }
  /// The same over what moves: the largest Σ |p_i| of the nodes so far, or the impulse. A body that spins about its
  /// centre has no linear momentum to compare with.
  double relative_linear_error() const { return ratio(linear_error(), linear_scale, linear_impulse); }
  double relative_angular_error() const { return ratio(angular_error(), angular_scale, angular_impulse); }

 private:
  static double ratio(const Eigen::Vector3d& error, double scale, const Eigen::Vector3d& impulse) {
    const double largest = std::max(scale, impulse.norm());
    return largest > 0 ? error.norm() / largest : 0;
  }
};

} // namespace iga::solve
