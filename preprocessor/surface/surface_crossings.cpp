#include "preprocessor/surface/surface_crossings.hpp"

#include "format/model/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tbb/parallel_for.h>

namespace iga::prep {

namespace {

using Index = std::size_t;
using Pair = std::pair<std::int32_t, std::int32_t>;
using Corners = std::array<Point3, 3>;

struct Facet {
  Corners p;
  Point3 normal; ///< unit length; zero for a facet without area
};

/// Where a triangle meets a plane: the interval along `direction`, and how far it reaches to both sides.
struct Cut {
  double first = 0, last = 0;
  double reach = 0; ///< smaller of the two distances; ≤ 0 where the triangle stays on one side
};

Cut cut(const Corners& p, const Point3& on_plane, const Point3& normal, const Point3& direction, const Point3& origin) {
  std::array<double, 3> d{}, s{};
  for (Index i = 0; i < 3; ++i) {
    d[i] = dot(normal, minus(p[i], on_plane));
    s[i] = dot(direction, minus(p[i], origin));
  }
  Cut out;
  out.reach = std::min(*std::max_element(d.begin(), d.end()), -*std::min_element(d.begin(), d.end()));
  bool any = false;
  for (Index i = 0; i < 3; ++i) {
    const Index j = (i + 1) % 3;
    if ((d[i] >= 0) == (d[j] >= 0)) continue;
    const double at = s[i] + (s[j] - s[i]) * d[i] / (d[i] - d[j]);
    out.first = any ? std::min(out.first, at) : at;
    out.last = any ? std::max(out.last, at) : at;
    any = true;
  }
  return out;
}

struct Depth {
  double depth = 0;
  Point3 where{};
};

/// Area that b covers of a (both in one plane): a clipped at b's edges, Sutherland & Hodgman (1974).
double covered_area(const Facet& a, const Facet& b, Point3& middle) {
  std::vector<Point3> polygon(a.p.begin(), a.p.end()), next;
  for (Index e = 0; e < 3 && !polygon.empty(); ++e) {
    const Point3 inward = cross(b.normal, minus(b.p[(e + 1) % 3], b.p[e]));
    next.clear();
    for (Index i = 0; i < polygon.size(); ++i) {
      const Point3& x = polygon[i];
      const Point3& y = polygon[(i + 1) % polygon.size()];
      const double dx = dot(inward, minus(x, b.p[e])), dy = dot(inward, minus(y, b.p[e]));
      if (dx >= 0) next.push_back(x);
      if ((dx >= 0) != (dy >= 0)) next.push_back(plus(x, times(minus(y, x), dx / (dx - dy))));
    }
    polygon.swap(next);
  }
  if (polygon.size() < 3) return 0;
  Point3 sum{};
  for (Index i = 1; i + 1 < polygon.size(); ++i)
    sum = plus(sum, cross(minus(polygon[i], polygon[0]), minus(polygon[i + 1], polygon[0])));
  middle = plus(polygon[0], times(minus(polygon[polygon.size() / 2], polygon[0]), 0.5));
  return 0.5 * norm(sum);
}

double longest_side(const Corners& p) {
  return std::max({norm(minus(p[1], p[0])), norm(minus(p[2], p[1])), norm(minus(p[0], p[2]))});
}

/// How deep two facets cross; 0 where they only touch.
Depth crossing_depth(const Facet& a, const Facet& b, double tolerance) {
  const Point3 across = cross(a.normal, b.normal);
  const double sine = norm(across);
  if (sine > 0) {
    const Point3 direction = times(across, 1 / sine);
    const Cut ca = cut(a.p, b.p[0], b.normal, direction, a.p[0]);
    if (ca.reach > tolerance) {
      const Cut cb = cut(b.p, a.p[0], a.normal, direction, a.p[0]);
      const double first = std::max(ca.first, cb.first), last = std::min(ca.last, cb.last);
      const double depth = std::min({ca.reach, cb.reach, last - first});
      if (depth <= tolerance) return {};
      // From a's first corner within a's plane to the common line, then along it.
      const Point3 towards = times(cross(a.normal, direction), -1);
      const double off = dot(b.normal, minus(b.p[0], a.p[0])) / dot(b.normal, towards);
      const Point3 on_line = plus(a.p[0], times(towards, off));
      return {depth, plus(on_line, times(direction, 0.5 * (first + last)))};
    }
  }
  double apart = 0;
  for (const Point3& x : a.p) apart = std::max(apart, std::abs(dot(b.normal, minus(x, b.p[0]))));
  if (apart > tolerance || dot(a.normal, b.normal) <= 0) return {};
  Point3 middle{};
  const double width = covered_area(a, b, middle) / std::min(longest_side(a.p), longest_side(b.p));
  return width > tolerance ? Depth{width, middle} : Depth{};
}

int shared_vertices(const Triangle& a, const Triangle& b) {
  int shared = 0;
  for (std::int32_t v : a) shared += static_cast<int>(std::count(b.begin(), b.end(), v));
  return shared;
}

void make_distinct(std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

// Facets about the middle of the part.
std::vector<Facet> make_facets(const TriangleMesh& mesh, const Point3& centre) {
  std::vector<Facet> facets(mesh.triangles.size());
  tbb::parallel_for(Index{0}, facets.size(), [&](Index t) {
    Facet& f = facets[t];
    for (Index i = 0; i < 3; ++i) f.p[i] = minus(corner(mesh, t, i), centre);
    const Point3 area = cross(minus(f.p[1], f.p[0]), minus(f.p[2], f.p[0]));
    const double length = norm(area);
    f.normal = length > 0 ? times(area, 1 / length) : Point3{};
  });
  return facets;
}

/// Pairs of facets with area whose boxes meet and that share no edge, ascending.
std::vector<Pair> near_pairs(const TriangleMesh& mesh, const std::vector<Facet>& facets) {
  const TriangleTree tree(mesh);
  std::vector<Box3> boxes(facets.size());
  tbb::parallel_for(Index{0}, facets.size(), [&](Index t) {
    boxes[t] = bounding_box(Corners{corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2)});
  });
  std::vector<std::vector<std::int32_t>> later(facets.size()); // of each facet, those with higher numbers
  tbb::parallel_for(Index{0}, facets.size(), [&](Index s) {
    if (facets[s].normal == Point3{}) return;
    tree.each_in_box(boxes[s], [&](Index t) {
      if (t > s && overlap(boxes[s], boxes[t]) && facets[t].normal != Point3{} &&
          shared_vertices(mesh.triangles[s], mesh.triangles[t]) < 2)
        later[s].push_back(static_cast<std::int32_t>(t));
    });
    std::sort(later[s].begin(), later[s].end());
  });
  std::vector<Pair> pairs;
  for (Index s = 0; s < later.size(); ++s)
    for (const std::int32_t t : later[s]) pairs.emplace_back(static_cast<std::int32_t>(s), t);
  return pairs;
}

} // namespace

Crossings find_crossings(const TriangleMesh& mesh, const Shells& shells, double tolerance) {
  const Box3 whole = bounding_box(mesh);
  const Point3 centre = plus(whole.lower, times(minus(whole.upper, whole.lower), 0.5));
  const std::vector<Facet> facets = make_facets(mesh, centre);
  const std::vector<Pair> candidates = near_pairs(mesh, facets);
  std::vector<Depth> depths(candidates.size());
  tbb::parallel_for(Index{0}, candidates.size(), [&](Index i) {
    const auto [s, t] = candidates[i];
    depths[i] = crossing_depth(facets[static_cast<Index>(s)], facets[static_cast<Index>(t)], tolerance);
  });
  Crossings out;
  for (Index i = 0; i < candidates.size(); ++i) {
    const auto [s, t] = candidates[i];
    const Pair owners = std::minmax(shells.shell[static_cast<Index>(s)], shells.shell[static_cast<Index>(t)]);
    if (owners.first != owners.second) out.touching.push_back(owners);
    if (depths[i].depth <= tolerance) continue;
    ++out.pairs;
    out.facets.push_back(candidates[i]);
    if (owners.first != owners.second) out.shells.push_back(owners);
    if (depths[i].depth > out.depth) {
      out.depth = depths[i].depth;
      out.where = plus(depths[i].where, centre);
    }
  }
  make_distinct(out.shells);
  make_distinct(out.touching);
  return out;
}

} // namespace iga::prep
