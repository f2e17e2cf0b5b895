// The half of a step that belongs to the nodes: momentum, velocity, and their energy, in one sweep over memory.
#pragma once

#include "solver/explicit/motion/explicit_body.hpp"

namespace iga::solve {

/// What acts on the nodes of a body at t_n and over which time. Empty vectors where nothing acts.
struct NodeForces {
  const Eigen::VectorXd *load = nullptr, *penalty = nullptr;
  double dt_last = 0; ///< t_n - t_{n-1}; 0 at the start of a run, where momentum and velocity are those of t_0
  double dt_next = 0; ///< t_{n+1} - t_n
};

/// Sums over the nodes of a body, taken in fixed order. Powers are those of the velocities before and after t_n.
struct NodeSums {
  struct Powers {
    double internal = 0, load = 0, damping = 0;
  } before, after;
  double kinetic = 0;                                       ///< ½ p_{n-1/2} · v_{n+1/2}
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();         ///< Σ p_{n+1/2}
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();        ///< Σ x_n × p_{n+1/2}
  Eigen::Vector3d linear_impulse = Eigen::Vector3d::Zero(); ///< of loads, penalties and damping about t_n
  Eigen::Vector3d angular_impulse = Eigen::Vector3d::Zero();
  double linear_scale = 0, angular_scale = 0; ///< Σ |p|, Σ |x × p|
};

/// p_{n+1/2} = ((1 - α h/2) p_{n-1/2} + h (f_load + f_penalty + M g - f_int)) / (1 + α h/2), h = (dt_last + dt_next)/2,
/// v = M⁻¹ p; in the first step p_{1/2} = p_0 + dt_next/2 (f - α p_0). Same bits for any number of threads.
NodeSums update_momentum(ExplicitBody& body, const NodeForces& forces);

/// What the forces would make of the velocity. (num_unknowns)
/// @return the time by which a force f more would add to it: gain M⁻¹ f
double next_velocity(const ExplicitBody& body, const NodeForces& forces, Eigen::VectorXd& velocity);

/// u += dt v.
void update_displacement(ExplicitBody& body, double dt);

/// Σ p, Σ x × p of the body as it stands: linear and angular only.
NodeSums momentum_of(const ExplicitBody& body);

} // namespace iga::solve
