// One trimmed span opened for work: the solid's part in it, its moments, and lines through it.
#pragma once

#include "preprocessor/fit/candidates.hpp"

namespace iga::prep {

/// Box units throughout: the box around the solid's part of the span is [0, 1]³. One object per thread, buffers are
/// kept. Points are (n × 3), row-major.
class SpanPart {
 public:
  /// All arguments must outlive the object.
  SpanPart(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far, const std::array<int, 3>& degree);

  /// Gathers the t-th touched span.
  void open(std::size_t touched);

  const LocalSurface& surface() const { return surface_; }
  const PieceInterior& interior() const { return interior_; }
  LineCaster& caster() { return caster_; }
  const std::array<int, 3>& degree() const { return degree_; }
  /// Tensor Legendre moments up to the degree, a fastest.
  std::span<const double> moments() const { return moments_; }
  /// Degree and moments of functions that are constant along an axis: those of a plane rule on a prism.
  std::array<int, 3> plane_degree(std::size_t axis) const;
  std::span<const double> plane_moments(std::size_t axis);

  /// Whether all points are proven to lie in the solid (PieceInterior::holds). Box units.
  bool holds(std::span<const double> points) const;

  /// ‖A w - b‖ / ‖b‖ over all moments.
  double residual(std::span<const double> points, std::span<const double> weights) const;

  /// Box units to spans relative to the span's lower corner, clamped to it; weights to span volumes. And back.
  void to_spans(std::vector<double>& points, std::vector<double>& weights) const;
  void to_box(std::vector<double>& points, std::vector<double>& weights) const;

 private:
  const SplineGrid* grid_;
  const Trimming* trimming_;
  const FarMoments* far_;
  std::array<int, 3> degree_;
  LocalSurface surface_;
  PieceInterior interior_;
  LineCaster caster_;
  std::vector<double> moments_, plane_moments_;
};

/// Tensor Gauss rule with n points per direction on the whole box, times `volume`. Overwrites points and weights.
void box_rule(const std::array<int, 3>& n, double volume, std::vector<double>& points, std::vector<double>& weights);

/// Plane rule times n Gauss points along the axis, plane fastest. Overwrites points and weights.
void prism_rule(std::size_t axis, int n, std::span<const double> plane_points, std::span<const double> plane_weights,
                std::vector<double>& points, std::vector<double>& weights);

} // namespace iga::prep
