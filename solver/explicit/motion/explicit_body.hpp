// One deformable body of an explicit run: space, mass, internal forces and state of motion.
#pragma once

#include "solver/explicit/kernel/internal_forces.hpp"
#include "solver/explicit/motion/contact_body.hpp"
#include "solver/mechanics/mass_operator.hpp"

#include <functional>
#include <optional>

namespace iga::solve {

struct BodySettings {
  std::string name = "body";
  KernelOptions kernel = {};
  LightTreatment light = {};
  MassType mass = MassType::Lumped;
  bool stop_at_inverted = false; ///< a point that inverts ends the run
  double damping = 0;            ///< mass-proportional, α of f = -α M v, 1/time
  Point3 acceleration{};         ///< gravity: body force / density, length/time²
};

/// The limit of the time step of the undeformed body.
struct StartStep {
  double omega = 0; ///< no frequency of the body lies above it, 1/time
  double dt = 0;    ///< 2 / omega
  bool by_lanczos = true;
  std::int64_t products = 0; ///< of Lanczos
  double element_dt = 0;     ///< by the bound of single spans; 0 where there is none
};

/// State at the time t_n that an integrator leads: u at t_n, momentum and velocity at the half step before.
/// Vectors (num_unknowns), component fastest, in the part's frame.
class ExplicitBody {
 public:
  /// @param model  must outlive the body
  /// @throws InputError for the consistent mass, which an explicit step cannot divide by; a damping below 0
  ExplicitBody(const TrimmedModel& model, const BodySettings& settings, const Law& law);

  const BodySettings& settings() const { return settings_; }
  const SolutionSpace& space() const { return *space_; }
  const MassOperator& mass() const { return mass_; }
  const ElasticMaterial& small_strain() const { return small_strain_; }
  const InternalForces& forces() const { return *forces_; }
  InternalForces& forces() { return *forces_; }
  std::int64_t num_unknowns() const { return space_->num_unknowns(); }

  Eigen::VectorXd displacement; ///< u, length
  Eigen::VectorXd velocity;     ///< v = M⁻¹ p, length/time
  Eigen::VectorXd momentum;     ///< p
  Eigen::VectorXd internal;     ///< f_int of the last evaluation, Eᵀ of that of the plain functions

  /// Overwrites velocity and momentum. Rigid: v = velocity + spin × (x - centre), exactly, through the Greville points.
  void set_rigid_velocity(const Point3& velocity, const Point3& spin, const Point3& centre);
  /// Any field v(x): lumped quasi-projection v_i = ∫ N_i v dV / ∫ N_i dV; second order, constants exact.
  void set_velocity(const std::function<Point3(const Point3&)>& field);
  /// Coefficients given directly.
  void set_velocity(Eigen::VectorXd velocities);

  /// f_int(u) into `internal`; see InternalForces::evaluate.
  ForceReport evaluate_forces(double dt);
  /// 1 / lumped mass of each node, 0 for massless ones; empty for the multi-pass masses. (num_nodes)
  const Eigen::VectorXd& inverse_mass() const { return inverse_mass_; }
  /// Greville points of the nodes. (num_nodes × 3)
  const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& node_points() const { return points_; }
  /// f = M g of the settings' acceleration; empty without one.
  const Eigen::VectorXd& weight() const { return weight_; }

  /// Lanczos on M⁻¹ K with the tangent at rest; the bound of single spans where that fails.
  /// @throws NumericalError where neither gives a limit
  StartStep start_step() const;

  /// u as the model's functions have it. (3 n_f)
  Eigen::VectorXd full_displacement() const;

 private:
  BodySettings settings_;
  std::unique_ptr<SolutionSpace> space_;
  std::shared_ptr<const Connectivity> connectivity_; // null for lumped masses
  ElasticMaterial small_strain_;
  MassOperator mass_;
  std::unique_ptr<InternalForces> forces_;
  bool plain_ = false;                                      // every active function is a node
  Eigen::SparseMatrix<double, Eigen::RowMajor> transposed_; // Eᵀ
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points_;
  Eigen::VectorXd full_u_, full_f_;
  Eigen::VectorXd inverse_mass_; // (num_nodes); lumped
  Eigen::VectorXd weight_;
};

} // namespace iga::solve
