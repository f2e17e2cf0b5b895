// Prescribed motion of a surface region without springs: velocities are projected after their update.
#pragma once

#include "solver/explicit/loads/driven_region.hpp"
#include "solver/explicit/motion/force_source.hpp"
#include "solver/mechanics/mass_operator.hpp"

#include <Eigen/SparseCholesky>

namespace iga::solve {

/// ∫ N_k · (v - v_D) dA = 0 for all functions N_k on the region, by forces G λ on their nodes, G = ∫ N_k N_j dA:
/// G (v + gain M⁻¹ G λ) = b v_D with b = ∫ N_k dA. G M⁻¹ G is singular where functions have dependent traces; the
/// equations agree with each other, and conjugate gradients on top of a factorisation with a shift of 1e-9 solve them.
/// The displacement is met at every t_{n+1}: nothing drifts. The step is not touched, nor any budget of stability.
class ProjectedRegion : public ConstraintSource {
 public:
  /// @param space  of the body-th body; must outlive it
  /// @param region  its stiffness and damping are not used
  /// @throws InputError for a region without area or one that drives nothing, naming it
  ProjectedRegion(const SolutionSpace& space, std::size_t body, DrivenRegion region);

  void add_reactions(const StepTimes& times, std::span<const ConstrainedBody> bodies) override;

  const RegionReport& region() const { return report_; }
  Point3 force() const { return force_; } ///< on the body in the last step
  /// Largest |∫ N_k (u - u_D) dA| / ∫ |N_k| Σ |N_j| dA of a driven component at the last t_n, length.
  double largest_miss() const { return largest_miss_; }

 private:
  double target(std::size_t component, double t) const;
  void factorise(const MassOperator& mass);
  /// G x, component by component, of a vector on the region's nodes (3 × nodes).
  Eigen::Matrix3Xd weigh(const Eigen::Matrix3Xd& x) const { return x * G_; }
  Eigen::Matrix3Xd accelerate(const MassOperator& mass, const Eigen::Matrix3Xd& forces);

  std::size_t body_;
  DrivenRegion settings_;
  RegionReport report_;
  std::vector<std::int32_t> nodes_; ///< ascending
  Eigen::SparseMatrix<double> G_;   ///< (nodes × nodes), symmetric; area
  Eigen::VectorXd area_, scale_;    ///< ∫ N_k dA and ∫ |N_k| Σ |N_j| dA, length²
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  bool factorised_ = false;
  Eigen::VectorXd forces_, accelerations_; ///< (num_unknowns), zero away from the region's nodes
  Point3 force_{};
  double largest_miss_ = 0;
};

} // namespace iga::solve
