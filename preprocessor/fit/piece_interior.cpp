#include "preprocessor/fit/piece_interior.hpp"

#include "format/model/line_crossing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::prep {

namespace {

// Vertices that lie beyond a facet's plane by no more than this (box units) do not make a solid non-convex.
constexpr double flat = 1e-12;
// Larger surfaces are not searched for being convex: the search is quadratic.
constexpr std::size_t most_planes = 96;

// Facets that fill up a block of lanes.
constexpr double far_away = 1e30;
// A facet whose area is a smaller share of its longest edge squared is a needle.
constexpr double needle_share = 1e-6;
// Facets that a point is looked at from before it is given up, and where on them (s, t without symmetry, so that ways
// from regular points to regular surfaces keep off edges and corners).
constexpr std::size_t most_targets = 32;
constexpr double target_s = 0.3141, target_t = 0.2718;
constexpr std::size_t no_facet = std::numeric_limits<std::size_t>::max();

Point3 area_vector(std::span<const Point3> v) {
  Point3 n{};
  for (std::size_t a = 1; a + 1 < v.size(); ++a) {
    const Point3 m = twice_area(v[0], v[a], v[a + 1]);
    for (std::size_t d = 0; d < 3; ++d) n[d] += m[d];
  }
  return n;
}

// Squared distance of x to the triangle a, a + ab, a + ac (Ericson 2005, section 5.1.5).
double squared_distance(const Point3& x, const Point3& a, const Point3& ab, const Point3& ac) {
  const Point3 ap{x[0] - a[0], x[1] - a[1], x[2] - a[2]};
  const auto from = [&](double s, double t) {
    double sum = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double e = ap[d] - s * ab[d] - t * ac[d];
      sum += e * e;
    }
    return sum;
  };
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  if (d1 <= 0 && d2 <= 0) return from(0, 0);
  const double d3 = d1 - bb, d4 = d2 - bc;
  if (d3 >= 0 && d4 <= d3) return from(1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return from(d1 / (d1 - d3), 0);
  const double d5 = d1 - bc, d6 = d2 - cc;
  if (d6 >= 0 && d5 <= d6) return from(0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return from(0, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return from(1 - t, t);
  }
  const double denominator = 1 / (va + vb + vc);
  return from(vb * denominator, vc * denominator);
}

// The same of a needle: the nearest of its edges, which its plane could only hide.
double squared_distance_to_edges(const Point3& x, const Point3& a, const Point3& ab, const Point3& ac) {
  const Point3 bc = minus(ac, ab), ax = minus(x, a), bx = minus(ax, ab);
  const auto to_edge = [](const Point3& from, const Point3& edge) {
    const double length2 = dot(edge, edge);
    const Point3 rest = minus(from, times(edge, length2 > 0 ? std::clamp(dot(from, edge) / length2, 0.0, 1.0) : 0.0));
    return dot(rest, rest);
  };
  return std::min({to_edge(ax, ab), to_edge(ax, ac), to_edge(bx, bc)});
}

double longest_edge_squared(const Point3& ab, const Point3& ac) {
  const Point3 bc = minus(ac, ab);
  return std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
}

} // namespace

void PieceInterior::attach(const LocalSurface& surface) {
  surface_ = &surface;
  find_planes();
  facets_.clear();
  targets_.clear();
  if (convex_) return;
  split_facets();
  choose_targets();
}

void PieceInterior::find_planes() {
  planes_.clear();
  convex_ = surface_->num_polygons() <= most_planes;
  for (std::size_t q = 0; convex_ && q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    Point3 n = area_vector(v);
    const double length = norm(n);
    if (length == 0) continue;
    for (double& c : n) c /= length;
    const double offset = dot(n, v[0]);
    const bool known = std::any_of(planes_.begin(), planes_.end(), [&](const Plane& p) {
      return std::abs(p.offset - offset) < flat && dot(p.n, n) > 1 - flat * flat;
    });
    if (known) continue;
    planes_.push_back({n, offset});
    convex_ = std::all_of(surface_->vertices.begin(), surface_->vertices.end(),
                          [&](const Point3& x) { return dot(n, x) <= offset + flat; });
  }
}

void PieceInterior::split_facets() {
  for (auto* bounds : {&lower_, &upper_})
    for (auto& values : *bounds) values.clear();
  for (std::size_t q = 0; q < surface_->num_polygons(); ++q) {
    const auto v = surface_->polygon(q);
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const std::size_t lane = facets_.size() % lanes;
      const Point3 ab = minus(v[a], v[0]), ac = minus(v[a + 1], v[0]), n = cross(ab, ac);
      const double longest = needle_share * longest_edge_squared(ab, ac);
      facets_.push_back({v[0], ab, ac, dot(n, n) < longest * longest});
      for (std::size_t d = 0; d < 3; ++d) {
        // What a block has too much lies far away.
        if (lane == 0) {
          lower_[d].push_back(Lanes{} + far_away);
          upper_[d].push_back(Lanes{} + far_away);
        }
        lower_[d].back()[lane] = std::min({v[0][d], v[a][d], v[a + 1][d]});
        upper_[d].back()[lane] = std::max({v[0][d], v[a][d], v[a + 1][d]});
      }
    }
  }
}

// Of x to the faces of the box and the surface; the former may be negative.
double PieceInterior::distance(const Point3& x) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const double c : x) nearest = std::min({nearest, c, 1 - c});
  if (nearest <= 0) return nearest;
  if (convex_) {
    for (const Plane& plane : planes_) nearest = std::min(nearest, plane.offset - dot(plane.n, x));
    return nearest;
  }
  double squared = nearest * nearest;
  for (std::size_t block = 0; block < lower_[0].size(); ++block) {
    Lanes away{};
    for (std::size_t d = 0; d < 3; ++d) {
      const Lanes below = lower_[d][block] - x[d], above = x[d] - upper_[d][block];
      const Lanes outside = below > above ? below : above;
      away += outside > 0 ? outside * outside : Lanes{};
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (away[lane] >= squared) continue;
      const Facet& f = facets_[lanes * block + lane];
      squared = std::min(squared, f.needle ? squared_distance_to_edges(x, f.a, f.ab, f.ac)
                                           : squared_distance(x, f.a, f.ab, f.ac));
    }
  }
  return std::sqrt(squared);
}

void PieceInterior::choose_targets() {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    const Point3 n = cross(facets_[f].ab, facets_[f].ac);
    order.emplace_back(-dot(n, n), f);
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(most_targets, order.size()));
  std::partial_sort(order.begin(), order.begin() + count, order.end());
  for (std::ptrdiff_t k = 0; k < count; ++k) targets_.push_back(order[static_cast<std::size_t>(k)].second);
}

// A way from x ends on a facet; just before it the winding number is that of the facet's side, and the crossings on the
// way tell by how much that of x differs.
bool PieceInterior::holds(const Point3& x) const {
  if (convex_)
    return std::all_of(planes_.begin(), planes_.end(),
                       [&](const Plane& plane) { return dot(plane.n, x) <= plane.offset + flat; });
  for (const std::size_t target : targets_) {
    const Facet& f = facets_[target];
    const Point3 goal = plus(f.a, plus(times(f.ab, target_s), times(f.ac, target_t))), way = minus(goal, x);
    const Point3 n = cross(f.ab, f.ac);
    const double depth = dot(way, n);
    const int side =
        detail::sure_sign(depth, 16 * std::numeric_limits<double>::epsilon() * norm(way) * norm(f.ab) * norm(f.ac));
    if (side == 0) continue;
    const std::optional<int> change = winding_change(x, way, target);
    if (!change) continue;
    const int winding = (side > 0 ? 1 : 0) - *change;
    if (winding == 0 || winding == 1) return winding == 1;
  }
  return false;
}

void PieceInterior::keep_inside(std::vector<double>& points) const {
  std::size_t kept = 0;
  for (std::size_t g = 0; g < points.size(); g += 3) {
    const Point3 x{points[g], points[g + 1], points[g + 2]};
    if (!holds(x)) continue;
    std::copy(x.begin(), x.end(), points.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += 3;
  }
  points.resize(kept);
}

double PieceInterior::clearance(const Point3& x) const {
  return distance(x);
}

double PieceInterior::clearance(const Point3& x, const Point3& inside) const {
  const double away = distance(x);
  return convex_ || away <= 0 || !left(x, inside) ? away : -away;
}

// Does the way from a point inside to x lead out? Where that is not sure, the point must prove itself.
bool PieceInterior::left(const Point3& x, const Point3& inside) const {
  const std::optional<int> change = winding_change(inside, minus(x, inside), no_facet);
  return change ? *change != 0 : !holds(x);
}

// Of the winding number from `from` to `from + way`; none where it is not sure.
std::optional<int> PieceInterior::winding_change(const Point3& from, const Point3& way, std::size_t skipped) const {
  Point3 low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    const double to = from[d] + way[d], slack = std::numeric_limits<double>::epsilon() * (1 + std::abs(to));
    low[d] = std::min(from[d], to) - slack;
    high[d] = std::max(from[d], to) + slack;
  }
  int total = 0;
  for (std::size_t block = 0; block < lower_[0].size(); ++block) {
    Lanes gap{};
    for (std::size_t d = 0; d < 3; ++d) {
      const Lanes below = lower_[d][block] - high[d], above = low[d] - upper_[d][block];
      const Lanes outside = below > above ? below : above;
      gap = outside > gap ? outside : gap;
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t facet = lanes * block + lane;
      if (gap[lane] > 0 || facet == skipped) continue;
      const Facet& f = facets_[facet];
      const std::optional<int> change = iga::winding_change(from, way, f.a, f.ab, f.ac);
      if (!change) return std::nullopt;
      total += *change;
    }
  }
  return total;
}

} // namespace iga::prep
