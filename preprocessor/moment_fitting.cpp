#include "preprocessor/moment_fitting.hpp"

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

// The solid's part fills its bounding box: volumes are exact to rounding, and a part that is not a box misses more.
constexpr double box_defect = 1e-12;
// A facet counts as parallel to an axis when its projected area along it is rounding (relative to its own area).
constexpr double parallel_defect = 1e-12;
// NNLS runs on until the residual is well below what is asked for, so that rounding of the points cannot spoil it.
constexpr double safety = 0.1;
constexpr int max_levels = 7;

// The solid's part is [0, 1] along `axis` times a plane region: every facet is parallel to the axis or caps an end.
bool is_prism(const LocalSurface& surface, std::size_t axis) {
  for (std::size_t q = 0; q < surface.num_polygons(); ++q) {
    const auto v = surface.polygon(q);
    const auto on = [&](double end) {
      return std::all_of(v.begin(), v.end(), [&](const Point3& x) { return x[axis] == end; });
    };
    if (on(0) || on(1)) continue;
    Point3 n{};
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const double x1 = v[a][0] - v[0][0], y1 = v[a][1] - v[0][1], z1 = v[a][2] - v[0][2];
      const double x2 = v[a + 1][0] - v[0][0], y2 = v[a + 1][1] - v[0][1], z2 = v[a + 1][2] - v[0][2];
      n[0] += y1 * z2 - z1 * y2;
      n[1] += z1 * x2 - x1 * z2;
      n[2] += x1 * y2 - y1 * x2;
    }
    if (std::abs(n[axis]) > parallel_defect * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])) return false;
  }
  return true;
}

} // namespace

MomentFitter::MomentFitter(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far,
                           const std::array<int, 3>& degree, double tolerance)
    : grid_(&grid), trimming_(&trimming), far_(&far), degree_(degree), tolerance_(tolerance) {
  moments_.resize(static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1)));
}

const SpanRule& MomentFitter::fit(std::size_t touched) {
  gather_local_surface(*grid_, *trimming_, touched, surface_);
  span_moments(surface_, far_->find(touched), degree_, moments_.data());
  caster_.attach(surface_);
  rule_ = {std::move(rule_.points), std::move(rule_.weights), 0, SpanShape::Free, false, 0};
  rule_.points.clear();
  rule_.weights.clear();
  if (moments_[0] >= 1 - box_defect) {
    fit_box();
  } else {
    std::size_t axis = 0;
    while (axis < 3 && !is_prism(surface_, axis)) ++axis;
    if (axis < 3) fit_prism(axis);
    if (axis == 3 || !(rule_.residual <= tolerance_)) fit_free();
  }
  // Box units → spans.
  const Box3& box = surface_.box;
  for (std::size_t g = 0; g < rule_.weights.size(); ++g) {
    rule_.weights[g] *= surface_.box_volume();
    for (std::size_t d = 0; d < 3; ++d) {
      double& x = rule_.points[3 * g + d];
      x = std::clamp(box.lower[d] + x * (box.upper[d] - box.lower[d]), 0.0, 1.0);
    }
  }
  return rule_;
}

void MomentFitter::fit_box() {
  rule_.shape = SpanShape::Box;
  std::array<const LineRule*, 3> g;
  for (std::size_t d = 0; d < 3; ++d) g[d] = &gauss_legendre(product_points(degree_[d]));
  for (std::size_t k = 0; k < g[2]->nodes.size(); ++k)
    for (std::size_t j = 0; j < g[1]->nodes.size(); ++j)
      for (std::size_t i = 0; i < g[0]->nodes.size(); ++i) {
        rule_.points.insert(rule_.points.end(), {g[0]->nodes[i], g[1]->nodes[j], g[2]->nodes[k]});
        rule_.weights.push_back(g[0]->weights[i] * g[1]->weights[j] * g[2]->weights[k] * moments_[0]);
      }
  finish_residual();
}

void MomentFitter::fit_prism(std::size_t axis) {
  rule_.shape = SpanShape::Prism;
  std::array<int, 3> plane = degree_;
  plane[axis] = 0;
  plane_moments_.clear();
  for (int c = 0; c <= plane[2]; ++c)
    for (int b = 0; b <= plane[1]; ++b)
      for (int a = 0; a <= plane[0]; ++a)
        plane_moments_.push_back(
            moments_[static_cast<std::size_t>(a + (degree_[0] + 1) * (b + (degree_[1] + 1) * c))]);
  fit_nnls(plane, plane_moments_, static_cast<int>(axis));
  const LineRule& g = gauss_legendre(product_points(degree_[axis]));
  for (std::size_t i = 0; i < g.nodes.size(); ++i)
    for (std::size_t q = 0; q < fit_weights_.size(); ++q) {
      Point3 x{fit_points_[3 * q], fit_points_[3 * q + 1], fit_points_[3 * q + 2]};
      x[axis] = g.nodes[i];
      rule_.points.insert(rule_.points.end(), x.begin(), x.end());
      rule_.weights.push_back(fit_weights_[q] * g.weights[i]);
    }
  finish_residual();
}

void MomentFitter::fit_free() {
  rule_.shape = SpanShape::Free;
  fit_nnls(degree_, moments_, -1);
  rule_.points = fit_points_;
  rule_.weights = fit_weights_;
  finish_residual();
}

// Candidates of one level: a first set along the main axis, then denser ones along all three axes in turn. Along a prism
// the lines stay in its middle plane.
void MomentFitter::append_level(int level, int prism_axis) {
  const int q = std::max({degree_[0], degree_[1], degree_[2]});
  const std::size_t main = caster_.main_axis();
  new_points_.clear();
  const std::vector<double> middle{0.5};
  const auto shoot = [&](std::size_t axis, int n, int per_line) {
    const std::size_t b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
    const std::vector<double>& lattice = gauss_legendre(std::min(n, 64)).nodes;
    caster_.append_candidates(axis, static_cast<int>(b) == prism_axis ? middle : lattice,
                              static_cast<int>(c) == prism_axis ? middle : lattice, per_line, new_points_);
  };
  const bool plane = prism_axis >= 0;
  std::size_t axis = main;
  if (static_cast<int>(axis) == prism_axis) axis = axis == 0 ? 1 : 0;
  if (level == 0) {
    // At least about two candidates for every moment; thin and pointed parts need more lines for that.
    const std::size_t wanted = 2 * (plane ? plane_moments_.size() : moments_.size());
    for (int n = plane ? 2 * q + 3 : q + 2; n <= 8 * (q + 2); n = n + n / 2) {
      new_points_.clear();
      shoot(axis, n, q + 2);
      if (new_points_.size() >= 3 * wanted) break;
    }
    return;
  }
  for (std::size_t d = 0; d < 3; ++d)
    if (static_cast<int>(d) != prism_axis) shoot(d, (plane ? 4 : 2) * (q + 1) + (q + 3) * level + static_cast<int>(d), q + 2 + level);
}

// Values of the tensor Legendre basis at points: one column of m entries a point.
void MomentFitter::evaluate_columns(const std::array<int, 3>& degree, std::span<const double> points) {
  const std::size_t n = points.size() / 3;
  const auto m = static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1));
  columns_.resize(n * m);
  double P[3][max_moment_degree + 1];
  double* out = columns_.data();
  for (std::size_t g = 0; g < n; ++g) {
    for (std::size_t d = 0; d < 3; ++d) legendre(points[3 * g + d], degree[d], P[d]);
    for (int c = 0; c <= degree[2]; ++c)
      for (int b = 0; b <= degree[1]; ++b) {
        const double bc = P[1][b] * P[2][c];
        for (int a = 0; a <= degree[0]; ++a) *out++ = P[0][a] * bc;
      }
  }
}

void MomentFitter::fit_nnls(const std::array<int, 3>& degree, std::span<const double> moments, int prism_axis) {
  const std::size_t m = moments.size();
  nnls_.start(moments);
  candidates_.clear();
  for (int level = 0; level <= max_levels; ++level) {
    append_level(level, prism_axis);
    evaluate_columns(degree, new_points_);
    std::size_t count = new_points_.size() / 3;
    if (level > 0) {
      // The residual is a polynomial; its integral over the solid is positive, so it is positive somewhere inside.
      // Only candidates where it is can lower it; take the best ones.
      rule_.refined = true;
      const auto r = nnls_.residual();
      position_.resize(count);
      std::vector<std::size_t> order;
      for (std::size_t g = 0; g < count; ++g) {
        double value = 0;
        for (std::size_t k = 0; k < m; ++k) value += r[k] * columns_[g * m + k];
        position_[g] = value;
        if (value > 0) order.push_back(g);
      }
      std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return position_[x] > position_[y]; });
      if (order.size() > 4 * m) order.resize(4 * m);
      std::vector<double> kept_points, kept_columns;
      for (std::size_t g : order) {
        kept_points.insert(kept_points.end(), &new_points_[3 * g], &new_points_[3 * g] + 3);
        kept_columns.insert(kept_columns.end(), &columns_[g * m], &columns_[g * m] + m);
      }
      new_points_.swap(kept_points);
      columns_.swap(kept_columns);
      count = order.size();
    }
    candidates_.insert(candidates_.end(), new_points_.begin(), new_points_.end());
    nnls_.add_columns(columns_, count);
    if (nnls_.solve(safety * tolerance_) == Nnls::Status::Converged) break;
  }
  rule_.nnls_steps += nnls_.num_steps();
  fit_points_.clear();
  fit_weights_.clear();
  for (std::size_t i = 0; i < nnls_.num_passive(); ++i) {
    const double* x = &candidates_[3 * nnls_.passive(i)];
    fit_points_.insert(fit_points_.end(), x, x + 3);
    fit_weights_.push_back(nnls_.weight(i));
  }
}

void MomentFitter::finish_residual() {
  evaluate_columns(degree_, rule_.points);
  const std::size_t m = moments_.size();
  double difference = 0, norm = 0;
  for (std::size_t k = 0; k < m; ++k) {
    double s = -moments_[k];
    for (std::size_t g = 0; g < rule_.weights.size(); ++g) s += rule_.weights[g] * columns_[g * m + k];
    difference += s * s;
    norm += moments_[k] * moments_[k];
  }
  rule_.residual = norm > 0 ? std::sqrt(difference / norm) : 0;
}

} // namespace iga::prep
