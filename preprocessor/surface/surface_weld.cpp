#include "preprocessor/surface/surface_weld.hpp"

#include "format/model/disjoint_sets.hpp"
#include "preprocessor/base/spatial_bin.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace iga::prep {

namespace {

using Index = std::size_t;

/// Puts every vertex on its root; vertices without facets stay until keep_triangles removes them.
std::int64_t apply_roots(Surface& surface, std::vector<std::int32_t>& parent) {
  std::int64_t joined = 0;
  for (Index v = 0; v < parent.size(); ++v)
    if (find_root(parent, static_cast<std::int32_t>(v)) != static_cast<std::int32_t>(v)) ++joined;
  for (Triangle& t : surface.mesh.triangles)
    for (std::int32_t& v : t) v = find_root(parent, v);
  return joined;
}

std::int64_t count_odd_edges(std::span<const Triangle> triangles) {
  const EdgeTable edges = make_edge_table(triangles);
  std::int64_t odd = 0;
  for (Index e = 0; e < edges.num_edges(); ++e) odd += static_cast<std::int64_t>(edges.edge(e).size() % 2);
  return odd;
}

std::vector<std::int32_t> open_vertices(const TriangleMesh& mesh) {
  const EdgeTable edges = make_edge_table(mesh.triangles);
  std::vector<std::int32_t> out;
  for (Index e = 0; e < edges.num_edges(); ++e)
    if (edges.edge(e).size() % 2 == 1) {
      out.push_back(edges.edge(e)[0].lo);
      out.push_back(edges.edge(e)[0].hi);
    }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Union-find over `candidates` within `tolerance`; the smallest number of a cluster is its root.
std::vector<std::int32_t> near_roots(const TriangleMesh& mesh, const std::vector<std::int32_t>& candidates,
                                     double tolerance) {
  std::vector<std::int32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const Point3 base = bounding_box(mesh).lower;
  const double width = 8 * tolerance; // wide cells: the ball rarely reaches a neighbour
  std::unordered_map<SpatialBin, std::vector<std::int32_t>, SpatialBinHash> cells;
  cells.reserve(candidates.size());
  for (std::int32_t v : candidates) {
    const Point3& x = mesh.vertices[static_cast<Index>(v)];
    SpatialBin cell{}, low{}, high{};
    for (Index d = 0; d < 3; ++d) {
      const double at = (x[d] - base[d]) / width;
      cell[d] = static_cast<std::int64_t>(std::floor(at));
      low[d] = static_cast<std::int64_t>(std::floor(at - tolerance / width));
      high[d] = static_cast<std::int64_t>(std::floor(at + tolerance / width));
    }
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k) {
          const auto found = cells.find({i, j, k});
          if (found == cells.end()) continue;
          for (std::int32_t w : found->second) {
            if (norm(minus(mesh.vertices[static_cast<Index>(w)], x)) > tolerance) continue;
            const std::int32_t a = find_root(parent, v), b = find_root(parent, w);
            parent[static_cast<Index>(std::max(a, b))] = std::min(a, b);
          }
        }
    cells[cell].push_back(v);
  }
  return parent;
}

bool collapsed(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

} // namespace

std::int64_t weld_equal_vertices(Surface& surface) {
  TriangleMesh& mesh = surface.mesh;
  for (Point3& x : mesh.vertices)
    for (double& c : x) c += 0.0; // −0 + 0 = 0
  // Open addressing over the coordinates' bits; the first vertex at a position is the root.
  const Index capacity = std::bit_ceil(2 * mesh.vertices.size() + 2);
  std::vector<std::int32_t> slots(capacity, -1);
  std::vector<std::int32_t> parent(mesh.vertices.size());
  for (Index v = 0; v < parent.size(); ++v) {
    std::uint64_t hash = 0;
    for (double c : mesh.vertices[v]) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32;
    }
    Index slot = static_cast<Index>(hash) & (capacity - 1);
    while (slots[slot] >= 0 && mesh.vertices[static_cast<Index>(slots[slot])] != mesh.vertices[v])
      slot = (slot + 1) & (capacity - 1);
    if (slots[slot] < 0) slots[slot] = static_cast<std::int32_t>(v);
    parent[v] = slots[slot];
  }
  const std::int64_t joined = apply_roots(surface, parent);
  keep_triangles(surface, std::vector<bool>(mesh.triangles.size(), true));
  return joined;
}

NearWeld weld_near_vertices(Surface& surface) {
  NearWeld out;
  std::int64_t open = count_odd_edges(surface.mesh.triangles);
  if (open == 0) return out;
  const double diag = diagonal(bounding_box(surface.mesh));
  const std::vector<std::int32_t> candidates = open_vertices(surface.mesh);
  std::vector<std::int32_t> best;
  for (double relative : {1e-9, 1e-8, 1e-7, 1e-6}) {
    if (open == 0) break;
    std::vector<std::int32_t> parent = near_roots(surface.mesh, candidates, relative * diag);
    std::vector<Triangle> triangles = surface.mesh.triangles;
    for (Triangle& t : triangles)
      for (std::int32_t& v : t) v = find_root(parent, v);
    const std::int64_t left = count_odd_edges(triangles);
    if (left >= open) continue;
    open = left;
    best = std::move(parent);
    out.tolerance = relative * diag;
  }
  if (best.empty()) return out;
  out.joined = apply_roots(surface, best);
  drop_collapsed_facets(surface);
  return out;
}

std::int64_t drop_collapsed_facets(Surface& surface) {
  const auto& triangles = surface.mesh.triangles;
  std::vector<bool> keep(triangles.size());
  std::int64_t dropped = 0;
  for (Index t = 0; t < triangles.size(); ++t) {
    keep[t] = !collapsed(triangles[t]);
    dropped += keep[t] ? 0 : 1;
  }
  keep_triangles(surface, keep);
  return dropped;
}

namespace {

/// Facets on one vertex triple, parted by orientation.
struct Twins {
  std::vector<Index> even, odd; ///< facets whose vertex order is an even or odd permutation of the sorted triple
};

bool is_even(const Triangle& t) {
  const auto smallest = static_cast<Index>(std::min_element(t.begin(), t.end()) - t.begin());
  return t[(smallest + 1) % 3] < t[(smallest + 2) % 3];
}

/// Balance of every directed edge, looked up by its ends.
class Balances {
 public:
  explicit Balances(const EdgeTable& edges) {
    for (Index e = 0; e < edges.num_edges(); ++e) {
      const auto uses = edges.edge(e);
      sums_.push_back({{uses[0].lo, uses[0].hi}, edge_balance(uses)});
    }
  }
  /// Sum over the facet's edges of |balance| after adding `copies` of it.
  int imbalance(const Triangle& t, int copies) const {
    int sum = 0;
    for (Index i = 0; i < 3; ++i) {
      const auto a = t[i], b = t[(i + 1) % 3];
      const int direction = a < b ? 1 : -1;
      sum += std::abs(sums_[find(a, b)].second + direction * copies);
    }
    return sum;
  }
  void add(const Triangle& t, int copies) {
    for (Index i = 0; i < 3; ++i) {
      const auto a = t[i], b = t[(i + 1) % 3];
      sums_[find(a, b)].second += (a < b ? 1 : -1) * copies;
    }
  }

 private:
  Index find(std::int32_t a, std::int32_t b) const {
    const std::pair<std::int32_t, std::int32_t> key{std::min(a, b), std::max(a, b)};
    const auto at =
        std::lower_bound(sums_.begin(), sums_.end(), key, [](const auto& s, const auto& k) { return s.first < k; });
    return static_cast<Index>(at - sums_.begin());
  }
  std::vector<std::pair<std::pair<std::int32_t, std::int32_t>, int>> sums_;
};

} // namespace

DuplicateFacets drop_duplicate_facets(Surface& surface) {
  DuplicateFacets out;
  const auto& triangles = surface.mesh.triangles;
  std::vector<std::pair<Triangle, Index>> sorted(triangles.size());
  for (Index t = 0; t < triangles.size(); ++t) {
    sorted[t] = {triangles[t], t};
    std::sort(sorted[t].first.begin(), sorted[t].first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<Twins> groups;
  for (Index i = 0; i < sorted.size();) {
    Index j = i;
    while (j < sorted.size() && sorted[j].first == sorted[i].first) ++j;
    if (j - i > 1) {
      Twins twins;
      for (Index k = i; k < j; ++k)
        (is_even(triangles[sorted[k].second]) ? twins.even : twins.odd).push_back(sorted[k].second);
      groups.push_back(std::move(twins));
    }
    i = j;
  }
  if (groups.empty()) return out;

  const EdgeTable edges = make_edge_table(triangles);
  std::vector<bool> keep(triangles.size(), true);
  const auto drop_last = [&](std::vector<Index>& facets) {
    keep[facets.back()] = false;
    facets.pop_back();
  };
  // First copies in the same orientation: all of them where that leaves the surface no more open than it was (a whole
  // body given twice), else one by one where it helps its own edges.
  const auto total = [](const EdgeTable& table) {
    std::int64_t sum = 0;
    for (Index e = 0; e < table.num_edges(); ++e) sum += std::abs(edge_balance(table.edge(e)));
    return sum;
  };
  std::vector<Triangle> single;
  {
    std::vector<bool> first(triangles.size(), true);
    for (const Twins& g : groups)
      for (const auto* side : {&g.even, &g.odd})
        for (Index k = 1; k < side->size(); ++k) first[(*side)[k]] = false;
    for (Index t = 0; t < triangles.size(); ++t)
      if (first[t]) single.push_back(triangles[t]);
  }
  const bool all = total(make_edge_table(single)) <= total(edges);
  Balances balances(edges);
  for (Twins& g : groups)
    for (auto* side : {&g.even, &g.odd})
      while (side->size() > 1) {
        const Triangle& t = triangles[side->back()];
        if (!all && balances.imbalance(t, -1) >= balances.imbalance(t, 0)) break;
        balances.add(t, -1);
        drop_last(*side);
        ++out.repeated;
      }
  // Then opposite pairs. Together they change no balance; where one alone closes its edges, that one stays.
  for (Twins& g : groups)
    while (!g.even.empty() && !g.odd.empty()) {
      const Triangle& even = triangles[g.even.back()];
      const Triangle& odd = triangles[g.odd.back()];
      const int now = balances.imbalance(even, 0);
      if (balances.imbalance(even, -1) < now) {
        balances.add(even, -1);
        drop_last(g.even);
        ++out.repeated;
      } else if (balances.imbalance(odd, -1) < now) {
        balances.add(odd, -1);
        drop_last(g.odd);
        ++out.repeated;
      } else {
        drop_last(g.even);
        drop_last(g.odd);
        out.cancelled += 2;
      }
    }
  keep_triangles(surface, keep);
  return out;
}

std::int64_t count_needle_facets(const TriangleMesh& mesh) {
  const double diag = diagonal(bounding_box(mesh));
  std::int64_t count = 0;
  for (Index t = 0; t < mesh.triangles.size(); ++t)
    if (0.5 * norm(area_vector(mesh, t)) < 1e-14 * diag * diag) ++count;
  return count;
}

} // namespace iga::prep
