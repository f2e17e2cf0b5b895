// Free parts under loads that do not balance: the part accelerates, and its own inertia takes the rest up.
#pragma once

#include "solver/analysis/static_analysis.hpp"
#include "solver/linalg/linear_solver.hpp"
#include "solver/mechanics/loads.hpp"
#include "solver/mechanics/rigid_modes.hpp"

namespace iga::solve {

/// f - M R a with the rigid accelerations a = (Rᵀ M R)⁻¹ Rᵀ f of each mechanical body, R its rigid motions about its
/// centre of mass. K u = f - M R a has solutions; the one with Rᵀ M u = 0 is taken: what moves is the shape alone.
class InertiaRelief {
 public:
  /// @param K  of the system: nodes that it connects move together
  InertiaRelief(const BodySystem& system, const StiffnessMatrix& K);

  /// Accelerations under a load vector. (bodies)
  std::vector<RigidAcceleration> accelerations(const Eigen::VectorXd& f) const;
  /// M R a. (num_unknowns)
  Eigen::VectorXd inertia(const std::vector<RigidAcceleration>& accelerations) const;
  /// The same as force/length³ in a body of the system; none where parts of it move apart.
  std::optional<BodyForce> body_force(const std::vector<RigidAcceleration>& accelerations, std::size_t body) const;
  /// u without its rigid share.
  Eigen::VectorXd without_rigid(const Eigen::VectorXd& u) const;

  /// K + σ M is positive definite; a small σ leaves little to be made good by refinement.
  const MassMatrix& mass() const { return M_; }
  double sigma() const { return sigma_; }

 private:
  const BodySystem* system_;
  MassMatrix M_;
  Bodies bodies_;
  double sigma_ = 0;
  Eigen::MatrixXd R_, MR_;                     ///< (num_unknowns × 6 bodies)
  std::vector<Eigen::Matrix<double, 6, 6>> G_; ///< Rᵀ M R by body
  std::vector<RigidAcceleration> plain_;       ///< names, mass and centre of each body
};

} // namespace iga::solve
