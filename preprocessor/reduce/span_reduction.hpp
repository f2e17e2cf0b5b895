// Reduces the rule of one trimmed span, after the shape of the solid's part in it.
#pragma once

#include "preprocessor/fit/moment_fitting.hpp"
#include "preprocessor/reduce/point_reduction.hpp"

namespace iga::prep {

/// Works through spans one at a time; one object per thread, buffers are kept.
class SpanReducer {
 public:
  /// @param rank_bound  at least as many points as the rank of the span's own stiffness asks for
  SpanReducer(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far, const std::array<int, 3>& degree,
              double tolerance, bool rank_bound);

  /// Reduces in place a rule that MomentFitter made for the t-th touched span.
  void reduce(std::size_t touched, SpanRule& rule);

  const ReductionCounts& counts() const { return reducer_.counts(); }

 private:
  std::size_t least_points() const;
  void reduce_box(SpanRule& rule);
  void reduce_prism(SpanRule& rule);
  void reduce_free(SpanRule& rule);

  std::size_t rank_points_; // 0: no bound
  double tolerance_;
  SpanPart part_;
  PointReducer reducer_;
  PointSet points_;
};

/// The fitted rule of an open span, or where that is a product of few points (boxes, prisms) the product with p + 1
/// points instead: it resists every field of the spline in the span. In spans, as SpanRule.
SpanRule resisting_rule(const SpanPart& part, const SpanRule& fitted, const std::array<int, 3>& spline_degree);

/// Product rules of an open span with more and more points, up to those of resisting_rule: candidates for a span whose
/// own product rule is too weak. Empty for spans without a product rule.
std::vector<SpanRule> stronger_products(const SpanPart& part, const SpanRule& own,
                                        const std::array<int, 3>& spline_degree);

/// Points that a span of this spline degree needs to have the full rank 3 Π (p + 1) - 6 of its own stiffness: six
/// independent strains a point.
std::size_t rank_points(const std::array<int, 3>& spline_degree);

} // namespace iga::prep
