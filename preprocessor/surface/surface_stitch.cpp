#include "preprocessor/surface/surface_stitch.hpp"

#include "preprocessor/base/spatial_bin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace iga::prep {

namespace {

using Index = std::size_t;

/// Vertices that were joined, with the facets around each cluster and the middle of its members.
class Clusters {
 public:
  explicit Clusters(const TriangleMesh& mesh)
      : triangles_(mesh.triangles), parent_(mesh.vertices.size()), count_(mesh.vertices.size(), 1), sum_(mesh.vertices),
        facets_(mesh.vertices.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (Index t = 0; t < triangles_.size(); ++t)
      for (std::int32_t v : triangles_[t]) facets_[static_cast<Index>(v)].push_back(static_cast<std::int32_t>(t));
  }

  std::int32_t root(std::int32_t v) {
    while (parent_[static_cast<Index>(v)] != v) {
      auto& p = parent_[static_cast<Index>(v)];
      p = parent_[static_cast<Index>(p)];
      v = p;
    }
    return v;
  }

  /// False where a facet has a corner in both clusters.
  bool may_join(std::int32_t a, std::int32_t b) {
    if (a == b) return true;
    if (facets_[static_cast<Index>(a)].size() > facets_[static_cast<Index>(b)].size()) std::swap(a, b);
    for (std::int32_t f : facets_[static_cast<Index>(a)])
      for (std::int32_t v : triangles_[static_cast<Index>(f)])
        if (root(v) == b) return false;
    return true;
  }

  void join(std::int32_t a, std::int32_t b) {
    if (a == b) return;
    const auto keep = static_cast<Index>(std::min(a, b)), gone = static_cast<Index>(std::max(a, b));
    parent_[gone] = static_cast<std::int32_t>(keep);
    count_[keep] += count_[gone];
    sum_[keep] = plus(sum_[keep], sum_[gone]);
    facets_[keep].insert(facets_[keep].end(), facets_[gone].begin(), facets_[gone].end());
    facets_[gone].clear();
    ++joined_;
  }

  Point3 middle(std::int32_t root) const {
    return times(sum_[static_cast<Index>(root)], 1.0 / count_[static_cast<Index>(root)]);
  }
  bool is_joined(std::int32_t root) const { return count_[static_cast<Index>(root)] > 1; }
  std::int64_t joined() const { return joined_; }

 private:
  std::vector<Triangle> triangles_;
  std::vector<std::int32_t> parent_;
  std::vector<int> count_;
  std::vector<Point3> sum_;
  std::vector<std::vector<std::int32_t>> facets_;
  std::int64_t joined_ = 0;
};

struct OpenEdge {
  std::int32_t from = 0, to = 0;
  Point3 middle{};
  double length = 0;
};

std::vector<OpenEdge> open_edges(const TriangleMesh& mesh) {
  std::vector<OpenEdge> out;
  const EdgeTable edges = make_edge_table(mesh.triangles);
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() % 2 == 0) continue;
    const bool forward = edge_balance(uses) >= 0;
    const std::int32_t a = forward ? uses[0].lo : uses[0].hi, b = forward ? uses[0].hi : uses[0].lo;
    const Point3& x = mesh.vertices[static_cast<Index>(a)];
    const Point3& y = mesh.vertices[static_cast<Index>(b)];
    out.push_back({a, b, plus(x, times(minus(y, x), 0.5)), norm(minus(y, x))});
  }
  return out;
}

struct Match {
  double gap;
  Index first, second;
  bool opposite; ///< the edges run in opposite directions, as neighbours do
};

std::vector<Match> find_matches(const TriangleMesh& mesh, const std::vector<OpenEdge>& edges, double gap,
                                double max_ratio) {
  const Point3 base = bounding_box(mesh).lower;
  std::unordered_map<SpatialBin, std::vector<Index>, SpatialBinHash> cells;
  const auto apart = [&](std::int32_t a, std::int32_t b) {
    return norm(minus(mesh.vertices[static_cast<Index>(a)], mesh.vertices[static_cast<Index>(b)]));
  };
  std::vector<Match> out;
  for (Index e = 0; e < edges.size(); ++e) {
    SpatialBin cell{};
    for (Index d = 0; d < 3; ++d) cell[d] = static_cast<std::int64_t>(std::floor((edges[e].middle[d] - base[d]) / gap));
    for (std::int64_t i = -1; i <= 1; ++i)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto found = cells.find({cell[0] + i, cell[1] + j, cell[2] + k});
          if (found == cells.end()) continue;
          for (Index f : found->second) {
            const double limit = std::min(gap, max_ratio * std::min(edges[e].length, edges[f].length));
            const double against = std::max(apart(edges[e].from, edges[f].to), apart(edges[e].to, edges[f].from));
            const double along = std::max(apart(edges[e].from, edges[f].from), apart(edges[e].to, edges[f].to));
            if (std::min(against, along) <= limit) out.push_back({std::min(against, along), f, e, against <= along});
          }
        }
    cells[cell].push_back(e);
  }
  std::sort(out.begin(), out.end(), [](const Match& a, const Match& b) {
    return std::tie(a.gap, a.first, a.second) < std::tie(b.gap, b.first, b.second);
  });
  return out;
}

} // namespace

Stitching stitch_open_edges(Surface& surface, double max_gap, double max_ratio) {
  Stitching out;
  TriangleMesh& mesh = surface.mesh;
  Clusters clusters(mesh);
  constexpr double growth = 2;
  double gap = 1e-6 * diagonal(bounding_box(mesh));
  for (std::vector<OpenEdge> edges = open_edges(mesh); !edges.empty() && gap <= max_gap; gap *= growth) {
    std::vector<bool> matched(edges.size(), false);
    bool changed = false;
    for (const Match& m : find_matches(mesh, edges, gap, max_ratio)) {
      if (matched[m.first] || matched[m.second]) continue;
      const std::int32_t a = clusters.root(edges[m.first].from), b = clusters.root(edges[m.first].to);
      const std::int32_t c = clusters.root(m.opposite ? edges[m.second].to : edges[m.second].from);
      if (!clusters.may_join(a, c)) continue;
      const std::int32_t d = clusters.root(m.opposite ? edges[m.second].from : edges[m.second].to);
      if (!clusters.may_join(b, d)) continue;
      clusters.join(a, c);
      clusters.join(clusters.root(b), clusters.root(d));
      matched[m.first] = matched[m.second] = true;
      out.widest = std::max(out.widest, m.gap);
      changed = true;
    }
    if (!changed) continue;
    for (Triangle& t : mesh.triangles)
      for (std::int32_t& v : t) {
        v = clusters.root(v);
        if (clusters.is_joined(v)) mesh.vertices[static_cast<Index>(v)] = clusters.middle(v);
      }
    edges = open_edges(mesh);
  }
  out.joined = clusters.joined();
  keep_triangles(surface, std::vector<bool>(mesh.triangles.size(), true));
  return out;
}

} // namespace iga::prep
