#include "preprocessor/surface/surface_union.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/disjoint_sets.hpp"
#include "preprocessor/surface/surface_arrangement.hpp"
#include "preprocessor/surface/surface_weld.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace iga::prep {

namespace {

using Index = std::size_t;
using Exact = ExactKernel;

/// Triangles on the same three points: one stands for all, with the winding number's jump across it.
struct Sheet {
  Index triangle = 0; ///< its outside is where the triangle's normal points
  int jump = 0;       ///< inside less outside, > 0
};

bool is_even(const Triangle& t) {
  const auto smallest = static_cast<Index>(std::min_element(t.begin(), t.end()) - t.begin());
  return t[(smallest + 1) % 3] < t[(smallest + 2) % 3];
}

/// Sheets across which the winding number jumps; triangles that cancel make none.
std::vector<Sheet> make_sheets(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, Index>> sorted(triangles.size());
  for (Index t = 0; t < triangles.size(); ++t) {
    sorted[t] = {triangles[t], t};
    std::sort(sorted[t].first.begin(), sorted[t].first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<Sheet> out;
  for (Index i = 0, j = 0; i < sorted.size(); i = j) {
    int jump = 0;
    for (j = i; j < sorted.size() && sorted[j].first == sorted[i].first; ++j)
      jump += is_even(triangles[sorted[j].second]) ? 1 : -1;
    if (jump == 0) continue;
    Index k = i;
    while (is_even(triangles[sorted[k].second]) != (jump > 0)) ++k;
    out.push_back({sorted[k].second, std::abs(jump)});
  }
  return out;
}

/// Winding numbers by exact rays against the facets as they were before they were cut.
class WindingQuery {
 public:
  WindingQuery(const TriangleMesh& mesh, std::span<const std::int32_t> facets) {
    const auto point = [&](Index t, Index i) {
      const Point3& x = corner(mesh, t, i);
      return Exact::Point_3(x[0], x[1], x[2]);
    };
    for (std::int32_t f : facets) {
      const auto t = static_cast<Index>(f);
      Exact::Triangle_3 facet(point(t, 0), point(t, 1), point(t, 2));
      if (!facet.is_degenerate()) facets_.push_back(std::move(facet));
    }
    tree_.insert(facets_.begin(), facets_.end());
    tree_.build();
  }

  /// Winding number just outside of the sheet at x. @param normal  of the sheet, any length
  /// @return nothing where every ray tried meets an edge
  std::optional<int> outside(const Exact::Point_3& x, const Exact::Vector_3& normal) const {
    constexpr int max_rays = 64;
    std::uint32_t random = 12345;
    const auto next = [&] {
      random = random * 1664525U + 1013904223U;
      return static_cast<int>(random >> 12) - (1 << 19);
    };
    for (int ray = 0; ray < max_rays; ++ray) {
      Exact::Vector_3 direction(next(), next(), next());
      const auto side = CGAL::sign(direction * normal);
      if (side == CGAL::ZERO) continue;
      if (side == CGAL::NEGATIVE) direction = -direction;
      if (const std::optional<int> sum = count(x, direction)) return sum;
    }
    return std::nullopt;
  }

 private:
  using Facets = std::vector<Exact::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Exact, Facets::const_iterator>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Exact, Primitive>>;

  /// Facets that the ray leaves through less those it enters through; those through x do not count.
  std::optional<int> count(const Exact::Point_3& x, const Exact::Vector_3& direction) const {
    std::vector<Facets::const_iterator> hits;
    tree_.all_intersected_primitives(Exact::Ray_3(x, direction), std::back_inserter(hits));
    const Exact::Point_3 y = x + direction;
    int sum = 0;
    for (const auto& hit : hits) {
      const Exact::Triangle_3& t = *hit;
      if (CGAL::coplanar(t[0], t[1], t[2], x)) {
        if (CGAL::coplanar(t[0], t[1], t[2], y)) return std::nullopt;
        continue;
      }
      const auto turn = CGAL::orientation(x, y, t[0], t[1]);
      if (turn == CGAL::ZERO || CGAL::orientation(x, y, t[1], t[2]) != turn ||
          CGAL::orientation(x, y, t[2], t[0]) != turn)
        return std::nullopt; // through an edge
      const Exact::Vector_3 normal = CGAL::cross_product(t[1] - t[0], t[2] - t[0]);
      sum += normal * direction > 0 ? 1 : -1;
    }
    return sum;
  }

  Facets facets_;
  Tree tree_;
};

/// Sheets joined across edges with two sheets share one answer; the one with the largest triangle gives it.
class Choice {
 public:
  Choice(const Arrangement& arranged, const std::vector<Sheet>& sheets, const WindingQuery& winding)
      : arranged_(arranged), sheets_(sheets), winding_(winding), patch_(sheets.size()) {
    std::iota(patch_.begin(), patch_.end(), 0);
    std::vector<Triangle> triangles;
    for (const Sheet& s : sheets) triangles.push_back(arranged.triangles[s.triangle]);
    const EdgeTable edges = make_edge_table(triangles);
    for (Index e = 0; e < edges.num_edges(); ++e) {
      const auto uses = edges.edge(e);
      if (uses.size() != 2 || edge_balance(uses) != 0) continue;
      const auto a = static_cast<Index>(uses[0].triangle), b = static_cast<Index>(uses[1].triangle);
      if (sheets[a].jump == sheets[b].jump) join_sets(patch_, uses[0].triangle, uses[1].triangle);
    }
  }

  /// Whether each sheet parts winding number ≤ 0 from ≥ 1; nothing where a winding number cannot be told.
  std::optional<std::vector<bool>> boundary(const std::function<void(double)>& progress) {
    std::vector<std::int32_t> largest(sheets_.size(), -1);
    std::vector<double> area(sheets_.size(), -1);
    for (Index s = 0; s < sheets_.size(); ++s) {
      const auto root = static_cast<Index>(find_root(patch_, static_cast<std::int32_t>(s)));
      if (const double a = rounded_area(s); a > area[root]) {
        area[root] = a;
        largest[root] = static_cast<std::int32_t>(s);
      }
    }
    std::vector<bool> out(sheets_.size());
    for (Index s = 0; s < sheets_.size(); ++s) {
      if (largest[s] < 0) continue;
      io::stop_if_interrupted();
      progress(static_cast<double>(s) / static_cast<double>(sheets_.size()));
      const auto [a, b, c] = corners(static_cast<Index>(largest[s]));
      const auto outside = winding_.outside(CGAL::centroid(a, b, c), CGAL::cross_product(b - a, c - a));
      if (!outside) return std::nullopt;
      out[s] = *outside <= 0 && *outside + sheets_[static_cast<Index>(largest[s])].jump >= 1;
    }
    for (Index s = 0; s < sheets_.size(); ++s)
      out[s] = out[static_cast<Index>(find_root(patch_, static_cast<std::int32_t>(s)))];
    return out;
  }

 private:
  std::array<Exact::Point_3, 3> corners(Index s) const {
    const Triangle& t = arranged_.triangles[sheets_[s].triangle];
    const auto point = [&](Index i) { return arranged_.points[static_cast<Index>(t[i])]; };
    return {point(0), point(1), point(2)};
  }

  double rounded_area(Index s) const {
    std::array<Point3, 3> x;
    const auto exact = corners(s);
    for (Index i = 0; i < 3; ++i)
      x[i] = {CGAL::to_double(exact[i].x()), CGAL::to_double(exact[i].y()), CGAL::to_double(exact[i].z())};
    return norm(cross(minus(x[1], x[0]), minus(x[2], x[0])));
  }

  const Arrangement& arranged_;
  const std::vector<Sheet>& sheets_;
  const WindingQuery& winding_;
  std::vector<std::int32_t> patch_; ///< disjoint sets of sheets
};

} // namespace

Uniting unite_by_winding(Surface& surface, std::span<const std::int32_t> facets,
                         const std::function<void(double share)>& progress) {
  constexpr double cutting = 0.8; // of the time
  const auto report = [&](double share) {
    if (progress) progress(share);
  };
  Uniting out;
  const Arrangement arranged = arrange_facets(surface.mesh, facets, [&](double share) { report(cutting * share); });
  const std::vector<Sheet> sheets = make_sheets(arranged.triangles);
  const WindingQuery winding(surface.mesh, facets);
  const std::optional<std::vector<bool>> boundary =
      Choice(arranged, sheets, winding).boundary([&](double share) { report(cutting + (1 - cutting) * share); });
  if (!boundary) {
    out.failure = "the winding number beside a facet cannot be told";
    return out;
  }
  Surface result = surface;
  std::vector<bool> keep(surface.mesh.triangles.size(), true);
  for (std::int32_t f : facets) keep[static_cast<Index>(f)] = false;
  keep_triangles(result, keep);
  const auto offset = static_cast<std::int32_t>(result.mesh.vertices.size());
  for (const auto& p : arranged.points)
    result.mesh.vertices.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
  for (Index s = 0; s < sheets.size(); ++s) {
    if (!(*boundary)[s]) continue;
    const Triangle& t = arranged.triangles[sheets[s].triangle];
    const auto parent = static_cast<Index>(arranged.facet[sheets[s].triangle]);
    result.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    result.mesh.region.push_back(surface.mesh.region[parent]);
    result.normals.push_back({});
  }
  weld_equal_vertices(result);
  drop_collapsed_facets(result);
  if (result.mesh.triangles.empty() || !is_closed_chain(make_edge_table(result.mesh.triangles))) {
    out.failure = "what is enclosed at least once has no closed boundary";
    return out;
  }
  surface = std::move(result);
  out.cut_facets = arranged.cut_facets;
  return out;
}

} // namespace iga::prep
