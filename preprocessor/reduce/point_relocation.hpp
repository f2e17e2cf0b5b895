// Moves the points of one span until its moments are exact, inside the solid and with positive weights.
#pragma once

#include "preprocessor/fit/moment_equations.hpp"
#include "preprocessor/fit/piece_interior.hpp"

#include <Eigen/Cholesky>

namespace iga::prep {

/// Points on their way, with what is known of their distance to the surface (box units).
struct MovingPoints : PointSet {
  std::vector<double> clear; ///< (n) lower bound of the clearance
  std::vector<double> least; ///< (n) clearance that the point must keep
  void drop(std::size_t j);
};

/// How far the unknowns of a point may go in one step of comparable effort.
enum class Metric {
  Even, ///< the same for all points: the mean weight and half the box
  Near, ///< a point's own weight and its clearance: for parts whose points crowd at edges and corners
};

/// Gauss–Newton with minimum-norm steps (there are more unknowns than equations): z = -Jᵀ (J Jᵀ)⁻¹ r, halved until
/// every point stays inside, every weight positive and the residual falls. One object per thread, buffers are kept.
class PointRelocator {
 public:
  /// @param interior  of the span; must stay attached to it while this is in use
  void attach(const PieceInterior& interior) { interior_ = &interior; }
  void start(const std::array<int, 3>& degree, std::span<const double> moments, int fixed_axis) {
    equations_.start(degree, moments, fixed_axis);
  }
  const MomentEquations& equations() const { return equations_; }
  /// Points with their clearances, computed afresh.
  MovingPoints measured(const PointSet& points);

  /// What removing each point would cost: the squared length of the step that makes the moments exact again to first
  /// order, in units of the metric. Linearises at the points; `relocate_without` starts from there.
  /// @return false where the linear system is singular
  bool rank(const MovingPoints& points, Metric metric, std::vector<double>& cost);
  /// Takes points out of those that were ranked last and moves the others until ‖r‖ <= target ‖b‖.
  /// @param removed  ascending
  /// @param[out] kept  the others; meaningless on failure
  bool relocate_without(const MovingPoints& ranked, std::span<const std::size_t> removed, double target,
                        MovingPoints& kept);
  /// Moves all points until ‖r‖ <= target ‖b‖. Spoils the ranking.
  bool relocate(MovingPoints& points, Metric metric, double target);
  /// The same by NLopt: least squares with bounds (L-BFGS), for where Newton's steps leave the solid. The points may
  /// end outside: then it fails. Spoils the ranking.
  bool relocate_bounded(MovingPoints& points, double target);

  /// Whether every point is proven to lie in the solid, apart from the way it came.
  bool holds(const PointSet& points) const;
  /// ‖r‖ / ‖b‖ after the last of the calls above.
  double reached() const { return r_.norm() / equations_.norm(); }

 private:
  enum class Move { Refused, Slow, Fast };
  struct Linearisation {
    std::vector<UnknownScale> scale; ///< (n)
    Eigen::MatrixXd J, gram;         ///< (m × unknowns n), J Jᵀ
    Eigen::LLT<Eigen::MatrixXd> factor;
  };
  bool linearise(const MovingPoints& points, Metric metric, Linearisation& at);
  bool reduced_steps(std::span<const std::size_t> removed, double target, MovingPoints& points);
  Move move(MovingPoints& points, std::span<const UnknownScale> scale, const Eigen::VectorXd& step);

  const PieceInterior* interior_ = nullptr;
  MomentEquations equations_;
  Metric metric_ = Metric::Even; // of the ranking
  Linearisation ranked_, own_;   // of the ranking, of points on their way
  Eigen::MatrixXd whitened_;     // L⁻¹ J of the ranking
  Eigen::VectorXd r_, trial_r_;  // of the points that move, of a trial
  MovingPoints trial_;
};

} // namespace iga::prep
