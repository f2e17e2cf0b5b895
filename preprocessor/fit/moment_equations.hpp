// The moment equations of one span as a nonlinear system: unknown are the weights and the places of the points.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iga::prep {

/// Points and weights of one span, box units.
struct PointSet {
  std::vector<double> x; ///< (n × 3), row-major
  std::vector<double> w; ///< (n)
  std::size_t size() const { return w.size(); }
};

/// What one unit of the unknowns of a point stands for, box units.
struct UnknownScale {
  double weight, place;
};

/// r_m = Σ_k w_k φ_m(x_k) - b_m with tensor Legendre polynomials φ up to a degree per direction, a fastest. The
/// unknowns of a point are its weight, then the coordinates that may move.
class MomentEquations {
 public:
  /// @param moments     ((q_u + 1)(q_v + 1)(q_w + 1)); must outlive the use
  /// @param fixed_axis  direction in which points stay where they are (prisms), or -1
  void start(const std::array<int, 3>& degree, std::span<const double> moments, int fixed_axis);

  Eigen::Index num_moments() const { return static_cast<Eigen::Index>(b_.size()); }
  /// Of one point.
  Eigen::Index unknowns() const { return unknowns_; }
  bool moves(std::size_t d) const { return moves_[d]; }
  double norm() const { return norm_; } ///< ‖b‖

  /// @param x, w  (n × 3), (n)
  void residual(std::span<const double> x, std::span<const double> w, Eigen::VectorXd& r) const;
  void residual(const PointSet& points, Eigen::VectorXd& r) const { residual(points.x, points.w, r); }
  /// @param scale    (n)
  /// @param[out] J  (num_moments × unknowns · n): ∂r/∂unknowns, each column times its scale
  void jacobian(const PointSet& points, std::span<const UnknownScale> scale, Eigen::MatrixXd& J) const;

 private:
  std::array<int, 3> degree_{};
  std::array<bool, 3> moves_{};
  Eigen::Index unknowns_ = 4;
  std::span<const double> b_;
  double norm_ = 0;
};

/// ‖r‖ / ‖b‖ of a rule; 0 where all moments vanish.
double relative_residual(const std::array<int, 3>& degree, std::span<const double> moments,
                         std::span<const double> points, std::span<const double> weights);

} // namespace iga::prep
