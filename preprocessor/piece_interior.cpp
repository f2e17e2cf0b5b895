#include "preprocessor/piece_interior.hpp"

#include "format/model/vec3.hpp"

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
// A way that meets a facet this close to its edge (relative to the determinant's size) tells nothing.
constexpr double at_an_edge = 1e-12;

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

} // namespace

void PieceInterior::attach(const LocalSurface& surface, LineCaster& caster) {
  surface_ = &surface;
  caster_ = &caster;
  find_planes();
  facets_.clear();
  if (!convex_) split_facets();
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
      facets_.push_back({v[0], minus(v[a], v[0]), minus(v[a + 1], v[0])});
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
      squared = std::min(squared, squared_distance(x, f.a, f.ab, f.ac));
    }
  }
  return std::sqrt(squared);
}

double PieceInterior::clearance(const Point3& x) {
  return distance(x);
}

double PieceInterior::clearance(const Point3& x, const Point3& inside) {
  const double away = distance(x);
  return convex_ || away <= 0 || !left(x, inside) ? away : -away;
}

// Does the way from a point inside to x cross the surface an odd number of times? Where it meets an edge, lines decide.
bool PieceInterior::left(const Point3& x, const Point3& inside) const {
  const Point3 way = minus(x, inside);
  Point3 low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = std::min(x[d], inside[d]);
    high[d] = std::max(x[d], inside[d]);
  }
  bool odd = false;
  for (std::size_t block = 0; block < lower_[0].size(); ++block) {
    Lanes gap{};
    for (std::size_t d = 0; d < 3; ++d) {
      const Lanes below = lower_[d][block] - high[d], above = low[d] - upper_[d][block];
      const Lanes outside = below > above ? below : above;
      gap = outside > gap ? outside : gap;
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (gap[lane] > 0) continue;
      const Facet& f = facets_[lanes * block + lane];
      // inside + t · way = a + s · ab + r · ac (Möller & Trumbore 1997)
      const Point3 p = cross(way, f.ac), from = minus(inside, f.a), q = cross(from, f.ab);
      const double scale = dot(f.ab, p);
      const double s = dot(from, p), r = dot(way, q), t = dot(f.ac, q);
      const double sign = scale < 0 ? -1 : 1, size = std::abs(scale),
                   edge = at_an_edge * norm(way) * norm(f.ab) * norm(f.ac);
      const double least = std::min({sign * s, sign * r, size - sign * (s + r)});
      if (sign * t < -edge || sign * t > size + edge || least < -edge) continue;
      if (least <= edge || sign * t <= edge || sign * t >= size - edge) return !caster_->inside(x);
      odd = !odd;
    }
  }
  return odd;
}

} // namespace iga::prep
