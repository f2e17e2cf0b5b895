#include "preprocessor/fit/span_part.hpp"

#include "preprocessor/fit/moment_equations.hpp"

#include <algorithm>
#include <cmath>

namespace iga::prep {

SpanPart::SpanPart(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far,
                   const std::array<int, 3>& degree)
    : grid_(&grid), trimming_(&trimming), far_(&far), degree_(degree) {
  moments_.resize(static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1)));
}

void SpanPart::open(std::size_t touched) {
  gather_local_surface(*grid_, *trimming_, touched, surface_);
  span_moments(surface_, far_->find(touched), degree_, moments_.data());
  interior_.attach(surface_);
  caster_.attach(surface_, interior_);
}

std::array<int, 3> SpanPart::plane_degree(std::size_t axis) const {
  std::array<int, 3> plane = degree_;
  plane[axis] = 0;
  return plane;
}

std::span<const double> SpanPart::plane_moments(std::size_t axis) {
  const std::array<int, 3> plane = plane_degree(axis);
  plane_moments_.clear();
  for (int c = 0; c <= plane[2]; ++c)
    for (int b = 0; b <= plane[1]; ++b)
      for (int a = 0; a <= plane[0]; ++a)
        plane_moments_.push_back(moments_[static_cast<std::size_t>(a + (degree_[0] + 1) * (b + (degree_[1] + 1) * c))]);
  return plane_moments_;
}

bool SpanPart::holds(std::span<const double> points) const {
  for (std::size_t g = 0; g < points.size(); g += 3)
    if (!interior_.holds({points[g], points[g + 1], points[g + 2]})) return false;
  return true;
}

double SpanPart::residual(std::span<const double> points, std::span<const double> weights) const {
  return relative_residual(degree_, moments_, points, weights);
}

void SpanPart::to_spans(std::vector<double>& points, std::vector<double>& weights) const {
  const Box3& box = surface_.box;
  for (double& w : weights) w *= surface_.box_volume();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t d = i % 3;
    points[i] = std::clamp(box.lower[d] + points[i] * (box.upper[d] - box.lower[d]), 0.0, 1.0);
  }
}

void SpanPart::to_box(std::vector<double>& points, std::vector<double>& weights) const {
  const Box3& box = surface_.box;
  for (double& w : weights) w /= surface_.box_volume();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t d = i % 3;
    points[i] = (points[i] - box.lower[d]) / (box.upper[d] - box.lower[d]);
  }
}

void box_rule(const std::array<int, 3>& n, double volume, std::vector<double>& points, std::vector<double>& weights) {
  points.clear();
  weights.clear();
  std::array<const LineRule*, 3> g;
  for (std::size_t d = 0; d < 3; ++d) g[d] = &gauss_legendre(n[d]);
  for (std::size_t k = 0; k < g[2]->nodes.size(); ++k)
    for (std::size_t j = 0; j < g[1]->nodes.size(); ++j)
      for (std::size_t i = 0; i < g[0]->nodes.size(); ++i) {
        points.insert(points.end(), {g[0]->nodes[i], g[1]->nodes[j], g[2]->nodes[k]});
        weights.push_back(g[0]->weights[i] * g[1]->weights[j] * g[2]->weights[k] * volume);
      }
}

void prism_rule(std::size_t axis, int n, std::span<const double> plane_points, std::span<const double> plane_weights,
                std::vector<double>& points, std::vector<double>& weights) {
  points.clear();
  weights.clear();
  const LineRule& g = gauss_legendre(n);
  for (std::size_t i = 0; i < g.nodes.size(); ++i)
    for (std::size_t q = 0; q < plane_weights.size(); ++q) {
      Point3 x{plane_points[3 * q], plane_points[3 * q + 1], plane_points[3 * q + 2]};
      x[axis] = g.nodes[i];
      points.insert(points.end(), x.begin(), x.end());
      weights.push_back(plane_weights[q] * g.weights[i]);
    }
}

} // namespace iga::prep
