// What contact, loads and outputs see of a deformable body during a step, and what they give back.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <string>

namespace iga::solve {

/// The embedded surface of one body, fine enough for contact. Vertex k stands at x_k = X_k + Σ_i S_ki u_i, where S
/// holds the values of the *nodes'* shape functions (extension of light functions included: entries may be negative,
/// rows sum to 1). A force f_k on the vertex puts S_ki f_k on node i: resultants and moments are exact.
struct ContactSurface {
  std::string body;
  TriangleMesh mesh;                              ///< reference positions X, length, the part's frame
  Eigen::SparseMatrix<double, Eigen::RowMajor> S; ///< (num_vertices × num_nodes)
  double span_size = 0;                           ///< smallest side of a span, length
  double density = 0;                             ///< mass/length³
  double wave_speed = 0;                          ///< of the body's law at rest, length/time; 0: unknown
};

/// Where a force evaluation stands in time, and what the time-step control leaves to penalties.
struct StepTimes {
  double time = 0;      ///< t_n
  double dt_last = 0;   ///< t_n - t_{n-1}; 0 in the first evaluation of a run
  double dt = 0;        ///< t_{n+1} - t_n
  double budget = 0.76; ///< 4 - x² - 4 ξ x with x = dt ω_max: bound on dt² λ_max(M⁻¹ K) of all penalties together
  double lasting = 0.76; ///< budget that is left when dt has grown or stability has shrunk to the run's safety factor
  /// For springs that shall stay as they are while stability shrinks as crushed foam makes it (x grows 2.4 times), but
  /// not beyond that of the run's safety factor.
  double budget_to_last() const {
    constexpr double shrinkage = 2.4;
    return std::min(budget, std::max(lasting, 4 - shrinkage * shrinkage * (4 - budget)));
  }
};

/// State of one body at a force evaluation. All vectors (3 num_nodes), component fastest.
struct BodyState {
  const Eigen::VectorXd* displacement = nullptr; ///< u at t_n
  const Eigen::VectorXd* velocity = nullptr;     ///< v at t_{n-1/2}
  const Eigen::VectorXd* masses = nullptr;       ///< (num_nodes) row-sum lumped
  int mass_passes = 1;                           ///< of the multi-pass mass: divides the stability budget
  Eigen::VectorXd* force = nullptr;              ///< external forces are added here
  Eigen::VectorXd* penalty_sum = nullptr;        ///< (num_nodes) Σ k |N~_i| Σ_j |N~_j| of all penalties so far (8.2)
};

/// What one force evaluation adds to the balance of energy; work is that of the interval t_{n-1} … t_n (trapezoidal).
struct PenaltyEnergy {
  double stored = 0;   ///< work done against contact springs, recoverable part included (contact)
  double friction = 0; ///< dissipated, grows monotonically
  double damping = 0;  ///< dissipated by contact damping
};

} // namespace iga::solve
