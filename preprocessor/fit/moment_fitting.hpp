// Quadrature of one trimmed span: product rules where the solid's part is a box or a prism, else moment fitting with
// non-negative least squares over candidate points inside the solid.
#pragma once

#include "preprocessor/base/nnls.hpp"
#include "preprocessor/fit/span_part.hpp"

#include <Eigen/Cholesky>

namespace iga::prep {

enum class SpanShape { Box, Prism, Free };

/// Points of one span. All weights are positive, all points are proven to lie in the solid (PieceInterior).
struct SpanRule {
  std::vector<double> points;  ///< (n × 3), row-major, in spans relative to the span's lower corner, in [0, 1]
  std::vector<double> weights; ///< (n); in span volumes
  double residual = 0; ///< ‖A w - b‖ / ‖b‖ over all moments in box units, recomputed from points and weights
  SpanShape shape = SpanShape::Free;
  int axis = -1; ///< of a prism, whose points are those of a plane rule times Gauss points along it, plane fastest
  bool refined = false; ///< needed candidates beyond the first set
  int nnls_steps = 0;
};

/// Works through spans one at a time; one object per thread, buffers are kept.
class MomentFitter {
 public:
  MomentFitter(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far,
               const std::array<int, 3>& degree, double tolerance);
  /// The rule of the t-th touched span; valid until the next call. Check `residual` against the tolerance.
  const SpanRule& fit(std::size_t touched);
  /// The span of the last call, open.
  SpanPart& part() { return part_; }

 private:
  void fit_box();
  void fit_prism(std::size_t axis);
  void fit_free();
  void fit_nnls(const std::array<int, 3>& degree, std::span<const double> moments, int prism_axis);
  bool whiten_by_cholesky(std::size_t count);
  void fit_nnls_whitened(const std::array<int, 3>& degree, std::span<const double> moments, int prism_axis);
  void take_points();
  void shoot_first(int prism_axis, std::size_t num_moments);
  void shoot_more(int level, int prism_axis);
  void evaluate_columns(const std::array<int, 3>& degree, std::span<const double> points);

  std::array<int, 3> degree_;
  double tolerance_;

  SpanPart part_;
  Nnls nnls_;
  SpanRule rule_;
  std::vector<double> fit_points_, fit_weights_; // of the last NNLS, box units
  Eigen::MatrixXd gram_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  std::vector<double> rhs_; // moments, or their orthonormalised form
  std::vector<double> candidates_, new_points_, columns_;
};

/// Gauss points per direction of a product rule for moments up to degree q: just enough to be exact, at least two so
/// that a span with one product rule still resists every mode of bending.
inline int product_points(int q) {
  return q / 2 + 1 > 2 ? q / 2 + 1 : 2;
}

} // namespace iga::prep
