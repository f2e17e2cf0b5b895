// An edge that two pieces share is met at the same bits from both (computed from its lower to its upper end,
// half-open), so a line through a closed surface never slips through a seam or counts it twice.
#include "preprocessor/fit/candidates.hpp"

#include "format/model/vec3.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::prep {

namespace {

// Shorter stretches of a line (relative to the box) are skipped: their points would sit on the surface itself.
constexpr double shortest_interval = 1e-7;
// Opposite crossings closer than this are one place within rounding: two bodies touch, or the line grazes a fold.
constexpr double coincident = 1e-12;

// A line that meets a piece at a smaller angle than this runs along it: where it crosses is mostly rounding.
constexpr double grazing = 1e-7;

struct EdgePoint {
  double b, a; // coordinates along b and along the axis
};

EdgePoint edge_at(const Point3& low, const Point3& high, std::size_t axis, std::size_t b_axis, std::size_t c_axis,
                  double c) {
  const double t = (c - low[c_axis]) / (high[c_axis] - low[c_axis]);
  return {low[b_axis] + t * (high[b_axis] - low[b_axis]), low[axis] + t * (high[axis] - low[axis])};
}

// Sorts the crossings of a line and takes out opposite ones that coincide; rounding may have put them in either order.
template <class Crossing> void sort_and_cancel(std::vector<Crossing>& line) {
  std::sort(line.begin(), line.end(), [](const Crossing& x, const Crossing& y) { return x.at < y.at; });
  std::size_t kept = 0;
  for (const Crossing& crossing : line) {
    const bool cancels =
        kept > 0 && line[kept - 1].sign * crossing.sign < 0 && crossing.at - line[kept - 1].at <= coincident;
    if (cancels)
      --kept;
    else
      line[kept++] = crossing;
  }
  line.resize(kept);
}

bool runs_along(std::span<const Point3> v, std::size_t axis) {
  Point3 n{};
  for (std::size_t a = 1; a + 1 < v.size(); ++a) {
    const Point3 m = twice_area(v[0], v[a], v[a + 1]);
    for (std::size_t d = 0; d < 3; ++d) n[d] += m[d];
  }
  return n[axis] * n[axis] < grazing * grazing * dot(n, n);
}

} // namespace

std::size_t LineCaster::main_axis() const {
  Point3 shown{};
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const Point3 n = twice_area(v[0], v[a], v[a + 1]);
      for (std::size_t d = 0; d < 3; ++d) shown[d] += std::abs(n[d]);
    }
  }
  // On a near tie stay with the lower axis, so that rounding does not decide.
  std::size_t best = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (shown[d] > 1.001 * shown[best]) best = d;
  return best;
}

void LineCaster::cast(std::size_t axis, std::span<const double> bs, std::span<const double> cs) {
  const std::size_t b_axis = axis == 0 ? 1 : 0, c_axis = axis == 2 ? 1 : 2;
  const int orientation = axis == 1 ? -1 : 1;
  if (lines_.size() < bs.size() * cs.size()) lines_.resize(bs.size() * cs.size());
  for (std::size_t l = 0; l < bs.size() * cs.size(); ++l) lines_[l].clear();
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    double low = v[0][c_axis], high = low;
    for (const Point3& x : v) {
      low = std::min(low, x[c_axis]);
      high = std::max(high, x[c_axis]);
    }
    int along = -1; // not known yet
    const auto first = std::lower_bound(cs.begin(), cs.end(), low) - cs.begin();
    for (auto j = static_cast<std::size_t>(first); j < cs.size() && cs[j] < high; ++j) {
      // A convex polygon is entered by one rising and left by one falling edge.
      EdgePoint up{}, down{};
      int found = 0;
      for (std::size_t a = 0; a < v.size(); ++a) {
        const Point3& p = v[a];
        const Point3& n = v[a + 1 == v.size() ? 0 : a + 1];
        if (p[c_axis] <= cs[j] && cs[j] < n[c_axis]) {
          up = edge_at(p, n, axis, b_axis, c_axis, cs[j]);
          found |= 1;
        } else if (n[c_axis] <= cs[j] && cs[j] < p[c_axis]) {
          down = edge_at(n, p, axis, b_axis, c_axis, cs[j]);
          found |= 2;
        }
      }
      if (found != 3 || up.b == down.b) continue;
      const bool anticlockwise = up.b > down.b;
      const EdgePoint& left = anticlockwise ? down : up;
      const EdgePoint& right = anticlockwise ? up : down;
      const auto begin = std::lower_bound(bs.begin(), bs.end(), left.b) - bs.begin();
      for (auto i = static_cast<std::size_t>(begin); i < bs.size() && bs[i] < right.b; ++i) {
        if (along < 0) along = runs_along(v, axis);
        const double t = (bs[i] - left.b) / (right.b - left.b);
        const int sign = along ? 0 : anticlockwise ? orientation : -orientation;
        lines_[i + bs.size() * j].push_back({std::clamp(left.a + t * (right.a - left.a), 0.0, 1.0), sign});
      }
    }
  }
  for (std::size_t l = 0; l < bs.size() * cs.size(); ++l) sort_and_cancel(lines_[l]);
}

void LineCaster::append_candidates(std::size_t axis, std::span<const double> bs, std::span<const double> cs,
                                   int points_per_line, int min_points, std::vector<double>& points) {
  const std::size_t b_axis = axis == 0 ? 1 : 0, c_axis = axis == 2 ? 1 : 2;
  cast(axis, bs, cs);
  found_.clear();
  for (std::size_t j = 0; j < cs.size(); ++j)
    for (std::size_t i = 0; i < bs.size(); ++i) {
      Point3 x;
      x[b_axis] = bs[i];
      x[c_axis] = cs[j];
      const auto fill = [&](double from, double to) {
        const double length = to - from;
        if (length < shortest_interval) return;
        const int n = std::max(min_points, static_cast<int>(std::ceil(length * points_per_line - 1e-9)));
        for (double g : gauss_legendre(n).nodes) {
          x[axis] = from + length * g;
          found_.insert(found_.end(), x.begin(), x.end());
        }
      };
      const auto& line = lines_[i + bs.size() * j];
      const FaceState low = surface_->faces[2 * axis], high = surface_->faces[2 * axis + 1];
      if (line.empty()) {
        bool solid = false;
        if (low != FaceState::Crossed || high != FaceState::Crossed) {
          solid = low == FaceState::Full || high == FaceState::Full;
        } else {
          x[axis] = 0.5;
          solid = interior_->holds(x);
        }
        if (solid) fill(0, 1);
        continue;
      }
      bool alternates = line.front().sign != 0;
      for (std::size_t s = 0; s + 1 < line.size(); ++s) alternates = alternates && line[s].sign == -line[s + 1].sign;
      // A line that begins or ends on the wrong side of an empty or full face tells nothing.
      alternates = alternates && low != (line.front().sign > 0 ? FaceState::Empty : FaceState::Full) &&
                   high != (line.back().sign < 0 ? FaceState::Empty : FaceState::Full);
      if (!alternates) continue;
      if (line.front().sign > 0) fill(0, line.front().at);
      for (std::size_t s = 0; s + 1 < line.size(); ++s)
        if (line[s].sign < 0) fill(line[s].at, line[s + 1].at);
      if (line.back().sign < 0) fill(line.back().at, 1);
    }
  append_proven(points);
}

void LineCaster::append_inward_candidates(int degree, std::size_t max_rays, int points_per_ray,
                                          std::vector<double>& points) {
  const TriangleProductRule<double>& rule = triangle_product_rule<double>(degree);
  found_.clear();
  std::size_t num_rays = 0;
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q)
    num_rays += (surface_->polygon(q).size() - 2) * rule.weights.size();
  const std::size_t stride = num_rays / max_rays + 1; // every so many rays, where there are more than asked for
  std::size_t ray = 0;
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const Point3 n = twice_area(v[0], v[a], v[a + 1]);
      const double length = std::sqrt(dot(n, n));
      for (std::size_t k = 0; k < rule.weights.size(); ++k) {
        if (ray++ % stride != 0 || length == 0) continue;
        Point3 from;
        double leave = std::numeric_limits<double>::infinity(); // where the ray leaves the box
        const Point3 inward{-n[0] / length, -n[1] / length, -n[2] / length};
        for (std::size_t d = 0; d < 3; ++d) {
          from[d] = v[0][d] + rule.s[k] * (v[a][d] - v[0][d]) + rule.t[k] * (v[a + 1][d] - v[0][d]);
          if (inward[d] != 0) leave = std::min(leave, ((inward[d] > 0 ? 1 : 0) - from[d]) / inward[d]);
        }
        cast_ray(from, inward);
        double to = leave;
        int sign = 1;
        for (const Crossing& crossing : ray_)
          if (crossing.at > coincident && crossing.at < to) {
            to = crossing.at;
            sign = crossing.sign;
          }
        if (sign < 0 || !(to > shortest_interval)) continue;
        for (double g : gauss_legendre(points_per_ray).nodes)
          for (std::size_t d = 0; d < 3; ++d) found_.push_back(std::clamp(from[d] + g * to * inward[d], 0.0, 1.0));
      }
    }
  }
  append_proven(points);
}

void LineCaster::append_proven(std::vector<double>& points) {
  interior_->keep_inside(found_);
  points.insert(points.end(), found_.begin(), found_.end());
}

// Crossings of x + t · ray, t > 0, into ray_.
void LineCaster::cast_ray(const Point3& x, const Point3& ray) {
  ray_.clear();
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const Point3 n = twice_area(v[0], v[a], v[a + 1]);
      const double slope = dot(n, ray);
      if (slope == 0) continue;
      const double t = (dot(n, v[0]) - dot(n, x)) / slope;
      if (t < 0) continue;
      const Point3 hit{x[0] + t * ray[0], x[1] + t * ray[1], x[2] + t * ray[2]};
      constexpr double tolerance = 1e-12; // an edge counts for both of its triangles
      const double scale = -tolerance * dot(n, n);
      if (dot(n, twice_area(v[0], v[a], hit)) < scale || dot(n, twice_area(v[a], v[a + 1], hit)) < scale ||
          dot(n, twice_area(v[a + 1], v[0], hit)) < scale)
        continue;
      ray_.push_back({t, slope > 0 ? 1 : -1});
    }
  }
  sort_and_cancel(ray_);
}

} // namespace iga::prep
