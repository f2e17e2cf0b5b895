#include "preprocessor/reduce/span_reduction.hpp"

#include <algorithm>

namespace iga::prep {

namespace {

// Spans that the solid fills by less than this are not held to the rank bound: their neighbours stiffen them.
constexpr double healthy_fraction = 0.1;

} // namespace

std::size_t rank_points(const std::array<int, 3>& spline_degree) {
  std::size_t unknowns = 3;
  for (const int p : spline_degree) unknowns *= static_cast<std::size_t>(p + 1);
  return (unknowns - 6 + 5) / 6;
}

namespace {

// One layer of a prism's product rule: the plane rule, in the middle of the prism. Box units.
PointSet plane_rule(const SpanRule& prism, int layers) {
  const auto axis = static_cast<std::size_t>(prism.axis);
  const std::size_t count = prism.weights.size() / static_cast<std::size_t>(layers);
  const double share = gauss_legendre(layers).weights[0];
  PointSet plane{{prism.points.begin(), prism.points.begin() + static_cast<std::ptrdiff_t>(3 * count)},
                 {prism.weights.begin(), prism.weights.begin() + static_cast<std::ptrdiff_t>(count)}};
  for (std::size_t k = 0; k < count; ++k) {
    plane.x[3 * k + axis] = 0.5;
    plane.w[k] /= share;
  }
  return plane;
}

} // namespace

namespace {

// n points per direction on a box, n[axis] layers of the plane rule on a prism.
SpanRule product_with(const SpanPart& part, const SpanRule& product, const std::array<int, 3>& n) {
  SpanRule rule = product;
  part.to_box(rule.points, rule.weights);
  if (rule.shape == SpanShape::Box) {
    box_rule(n, part.moments()[0], rule.points, rule.weights);
  } else {
    const auto axis = static_cast<std::size_t>(rule.axis);
    const PointSet plane = plane_rule(rule, product_points(part.degree()[axis]));
    prism_rule(axis, n[axis], plane.x, plane.w, rule.points, rule.weights);
  }
  rule.residual = part.residual(rule.points, rule.weights);
  part.to_spans(rule.points, rule.weights);
  return rule;
}

} // namespace

SpanRule resisting_rule(const SpanPart& part, const SpanRule& fitted, const std::array<int, 3>& spline_degree) {
  if (fitted.shape == SpanShape::Free) return fitted;
  return product_with(part, fitted, {spline_degree[0] + 1, spline_degree[1] + 1, spline_degree[2] + 1});
}

std::vector<SpanRule> stronger_products(const SpanPart& part, const SpanRule& own,
                                        const std::array<int, 3>& spline_degree) {
  std::vector<SpanRule> rules;
  if (own.shape == SpanShape::Free) return rules;
  std::array<int, 3> least;
  for (std::size_t d = 0; d < 3; ++d) least[d] = product_points(part.degree()[d]);
  const auto add = [&](const std::array<int, 3>& n) { rules.push_back(product_with(part, own, n)); };
  if (own.shape == SpanShape::Prism) {
    const auto axis = static_cast<std::size_t>(own.axis);
    for (std::array<int, 3> n = least; n[axis] < spline_degree[axis] + 1;) {
      ++n[axis];
      add(n);
    }
    return rules;
  }
  // One more point in one direction, in two, in all three; then all that there may be.
  for (const unsigned more : {1u, 2u, 4u, 3u, 5u, 6u, 7u})
    add({least[0] + static_cast<int>(more & 1), least[1] + static_cast<int>(more >> 1 & 1),
         least[2] + static_cast<int>(more >> 2)});
  return rules;
}

SpanReducer::SpanReducer(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far,
                         const std::array<int, 3>& degree, double tolerance, bool rank_bound)
    : rank_points_(rank_bound ? rank_points(grid.degree()) : 0), tolerance_(tolerance),
      part_(grid, trimming, far, degree) {}

std::size_t SpanReducer::least_points() const {
  return part_.surface().fraction < healthy_fraction ? 0 : rank_points_;
}

void SpanReducer::reduce(std::size_t touched, SpanRule& rule) {
  const SpanRule fitted = rule;
  part_.open(touched);
  part_.to_box(rule.points, rule.weights);
  reducer_.attach(part_.interior());
  switch (rule.shape) {
  case SpanShape::Box:
    reduce_box(rule);
    break;
  case SpanShape::Prism:
    reduce_prism(rule);
    break;
  case SpanShape::Free:
    reduce_free(rule);
    break;
  }
  rule.residual = part_.residual(rule.points, rule.weights);
  part_.to_spans(rule.points, rule.weights);
  // In a sliver far thinner than a span positions have few digits left, and with them the moments: its rule stays.
  if (!(rule.residual <= tolerance_)) rule = fitted;
}

// Product rules have few points as they are; the bound may ask for more.
void SpanReducer::reduce_box(SpanRule& rule) {
  std::array<int, 3> n;
  for (std::size_t d = 0; d < 3; ++d) n[d] = product_points(part_.degree()[d]);
  const auto total = [&] { return static_cast<std::size_t>(n[0] * n[1] * n[2]); };
  if (total() >= least_points()) return;
  while (total() < least_points()) ++*std::min_element(n.begin(), n.end());
  box_rule(n, part_.moments()[0], rule.points, rule.weights);
}

void SpanReducer::reduce_prism(SpanRule& rule) {
  const auto axis = static_cast<std::size_t>(rule.axis);
  const int layers = product_points(part_.degree()[axis]);
  points_ = plane_rule(rule, layers);
  const std::size_t least = (least_points() + static_cast<std::size_t>(layers) - 1) / static_cast<std::size_t>(layers);
  reducer_.reduce(part_.plane_degree(axis), part_.plane_moments(axis), rule.axis, least, tolerance_, points_);
  prism_rule(axis, layers, points_.x, points_.w, rule.points, rule.weights);
}

void SpanReducer::reduce_free(SpanRule& rule) {
  points_.x.swap(rule.points);
  points_.w.swap(rule.weights);
  reducer_.reduce(part_.degree(), part_.moments(), -1, least_points(), tolerance_, points_);
  points_.x.swap(rule.points);
  points_.w.swap(rule.weights);
}

} // namespace iga::prep
