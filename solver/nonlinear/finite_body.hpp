// A body at large displacement: internal forces and tangent, total Lagrangian, from the laws of explicit runs.
#pragma once

#include "solver/explicit/kernel/internal_forces.hpp"
#include "solver/linalg/symmetric_matrix.hpp"
#include "solver/nonlinear/law_tangent.hpp"

namespace iga::solve {

/// ∂f/∂u of all that acts: lower triangle of A and, where it is not symmetric, that of Aᵀ.
struct Tangent {
  StiffnessMatrix lower, upper;
  bool symmetric = true;

  Tangent() = default;
  Tangent(const std::shared_ptr<const Connectivity>& connectivity, bool is_symmetric);
  void set_zero();
  /// Adds a span's matrix, whole; where the tangent is symmetric its symmetric part. Within for_spans, or one by one.
  void add(std::span<const std::int32_t> nodes, const Eigen::MatrixXd& block);
};

/// What one evaluation found at the quadrature points.
struct PointsReport {
  double min_J = 1; ///< smallest det F
  std::int64_t min_J_cell = -1;
  std::int64_t inverted = 0; ///< points below the law's min_volume_ratio
};

/// Against volumetric locking: which volume ratios the law sees.
enum class Locking {
  None, ///< those of the points
  FBar  ///< the mean of each cell: MeanVolume
};

/// f_i = ∫ P(F) ∂N_i/∂X dV with F = I + ∂u/∂X. Laws with a history go from the last state that was kept straight to the
/// present F. Vectors (num_unknowns), the part's frame. The same bits for any number of threads.
class FiniteBody {
 public:
  /// Space and connectivity (of this space alone) must outlive the body.
  FiniteBody(const SolutionSpace& space, const Law& law, std::shared_ptr<const Connectivity> connectivity,
             Locking locking = Locking::None);

  const SolutionSpace& space() const { return *space_; }
  const StaticLaw& law() const { return law_; }

  /// f += internal forces.
  PointsReport add_forces(const Eigen::VectorXd& u, Eigen::VectorXd& f) const;
  /// A += their derivative.
  void add_tangent(const Eigen::VectorXd& u, Tangent& A) const;
  /// The points' history moves on to u: a converged step.
  void keep(const Eigen::VectorXd& u);
  /// (model's points) the law sees these times F; empty where it sees F.
  std::vector<double> scales(const Eigen::VectorXd& u) const;

  /// As explicit runs have it, blocks of eight points; `point` numbers them in the model, -1 for none.
  PointHistory save() const;
  void load(const PointHistory& saved);
  std::span<const std::int64_t> point() const { return point_; }

 private:
  struct Work;
  void gather(const Eigen::VectorXd& u, std::int64_t a, Work& work) const;
  void add_coupling(Work& work) const;
  template <class Visit> void for_blocks(std::int64_t a, const Work& work, Visit&& visit) const;

  const SolutionSpace* space_;
  StaticLaw law_;
  std::shared_ptr<const Connectivity> connectivity_;
  Locking locking_;
  std::vector<std::int64_t> first_block_; ///< (num_cells + 1)
  std::vector<std::int64_t> point_;       ///< (8 blocks)
  std::vector<Lanes> history_;            ///< (blocks × history of the law)
  std::vector<Lanes> F_old_;              ///< (blocks × 9), or empty
};

} // namespace iga::solve
