#include "preprocessor/connectivity/node_sets.hpp"

#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace iga::prep {

namespace {

constexpr std::size_t max_nodes = (max_degree + 2) * (max_degree + 2) * (max_degree + 2); // of a span
constexpr std::uint8_t no_set = 255; // more than the sets of a span: at most half of its nodes, a chessboard
static_assert(max_nodes / 2 < no_set);
constexpr std::size_t spans_per_block = 1024;

// Labels the connected sets of one span by flood filling; returns their number.
std::uint8_t label_span(const LatticeNodes& nodes, std::size_t t, std::uint8_t* labels) {
  const std::int64_t n = nodes.per_span();
  assert(static_cast<std::size_t>(nodes.nodes_per_span()) <= max_nodes);
  std::fill(labels, labels + nodes.nodes_per_span(), no_set);
  std::uint8_t next = 0;
  std::array<Index3, max_nodes> stack; // a node is pushed once
  std::size_t pending = 0;
  Index3 seed;
  for (seed[2] = 0; seed[2] < n; ++seed[2])
    for (seed[1] = 0; seed[1] < n; ++seed[1])
      for (seed[0] = 0; seed[0] < n; ++seed[0]) {
        if (labels[nodes.node(seed)] != no_set || !nodes.inside(t, nodes.node(seed))) continue;
        labels[nodes.node(seed)] = next;
        stack[pending++] = seed;
        while (pending > 0) {
          const Index3 m = stack[--pending];
          for (std::size_t d = 0; d < 3; ++d)
            for (const std::int64_t step : {-1, 1}) {
              Index3 to = m, segment = m;
              to[d] += step;
              if (to[d] < 0 || to[d] >= n) continue;
              segment[d] = std::max(m[d], to[d]);
              const std::int64_t node = nodes.node(to);
              if (labels[node] != no_set || !nodes.inside(t, node) || nodes.blocked(t, d, segment)) continue;
              labels[node] = next;
              stack[pending++] = to;
            }
        }
        ++next;
      }
  return next;
}

// Six times the signed volume of a tetrahedron.
double orient(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const Point3 u = minus(b, a), v = minus(c, a), w = minus(d, a);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

bool meets(const Point3& p, const Point3& q, std::span<const Point3> polygon) {
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) {
    const Point3 &x = polygon[0], &y = polygon[a], &z = polygon[a + 1];
    if (orient(x, y, z, p) * orient(x, y, z, q) > 0) continue;
    const double e = orient(p, q, x, y), f = orient(p, q, y, z), g = orient(p, q, z, x);
    if ((e >= 0 && f >= 0 && g >= 0) || (e <= 0 && f <= 0 && g <= 0)) return true;
  }
  return false;
}

/// A touched span and what surrounds it; neighbours are looked up when they are first asked for.
class Neighbourhood {
 public:
  static constexpr std::int64_t interior = -1, exterior = -2;

  Neighbourhood(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
                std::size_t t)
      : grid_(grid), pieces_(pieces), state_(state), ijk_(grid.span_index(pieces.spans[t])) {
    known_.fill(unknown);
    known_[13] = static_cast<std::int64_t>(t);
  }
  const Index3& index() const { return ijk_; }
  std::int64_t own() const { return known_[13]; }
  /// Touched number of a neighbour, or what it is without surface; outside the grid: exterior.
  std::int64_t at(const std::array<std::int8_t, 3>& step) {
    auto& known = known_[static_cast<std::size_t>(13 + step[0] + 3 * step[1] + 9 * step[2])];
    if (known == unknown) known = look_up(step);
    return known;
  }

 private:
  static constexpr std::int64_t unknown = -3;

  std::int64_t look_up(const std::array<std::int8_t, 3>& step) const {
    Index3 i = ijk_;
    for (std::size_t d = 0; d < 3; ++d) {
      i[d] += step[d];
      if (i[d] < 0 || i[d] >= grid_.spans()[d]) return exterior;
    }
    const std::int64_t span = grid_.span_number(i);
    const auto found = std::lower_bound(pieces_.spans.begin(), pieces_.spans.end(), span);
    if (found != pieces_.spans.end() && *found == span) return found - pieces_.spans.begin();
    const bool inside = state_[static_cast<std::size_t>(span)] == static_cast<std::uint8_t>(SpanState::Interior);
    return inside ? interior : exterior;
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  const std::vector<std::uint8_t>& state_;
  Index3 ijk_;
  std::array<std::int64_t, 27> known_;
};

class NodeSetBuilder {
 public:
  NodeSetBuilder(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
                 const LatticeNodes& nodes)
      : grid_(grid), pieces_(pieces), state_(state), nodes_(nodes) {}

  NodeSets build() {
    const std::size_t num_touched = pieces_.spans.size();
    const std::size_t num_blocks = (num_touched + spans_per_block - 1) / spans_per_block;
    const auto volume = static_cast<std::size_t>(nodes_.nodes_per_span());
    labels_.resize(num_touched * volume);
    NodeSets sets;
    sets.first_set.assign(num_touched + 1, 0);
    sets.first_link.assign(num_touched + 1, 0);
    std::vector<std::vector<NodeLink>> links(num_blocks);
    const auto for_blocks = [&](auto&& work) {
      tbb::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t b) {
        for (std::size_t t = b * spans_per_block; t < std::min((b + 1) * spans_per_block, num_touched); ++t) work(b, t);
      });
    };
    for_blocks(
        [&](std::size_t, std::size_t t) { sets.first_set[t + 1] = label_span(nodes_, t, &labels_[t * volume]); });
    std::partial_sum(sets.first_set.begin(), sets.first_set.end(), sets.first_set.begin());
    sets.set_size.assign(static_cast<std::size_t>(sets.first_set.back()), 0);
    for_blocks([&](std::size_t b, std::size_t t) {
      const std::size_t before = links[b].size();
      link_span(t, links[b], sets.set_size.data() + sets.first_set[t]);
      sets.first_link[t + 1] = static_cast<std::int64_t>(links[b].size() - before);
    });
    std::partial_sum(sets.first_link.begin(), sets.first_link.end(), sets.first_link.begin());
    for (const auto& block : links) sets.links.insert(sets.links.end(), block.begin(), block.end());
    return sets;
  }

 private:
  /// A lattice node of a span or of one beside it.
  struct Place {
    std::array<std::int8_t, 3> step{}; ///< from the span to the one that holds the node
    std::int64_t touched = 0;          ///< as Neighbourhood::at
    std::uint8_t set = no_set;         ///< no_set outside the solid
  };

  std::uint8_t label(std::size_t t, const Index3& m) const {
    return labels_[t * static_cast<std::size_t>(nodes_.nodes_per_span()) + static_cast<std::size_t>(nodes_.node(m))];
  }

  Place place(Neighbourhood& around, Index3 m) const {
    const std::int64_t n = nodes_.per_span();
    Place p;
    if (std::min({m[0], m[1], m[2]}) >= 0 && std::max({m[0], m[1], m[2]}) < n) {
      p.touched = around.own();
      p.set = label(static_cast<std::size_t>(p.touched), m);
      return p;
    }
    for (std::size_t d = 0; d < 3; ++d) {
      p.step[d] = static_cast<std::int8_t>(m[d] < 0 ? -1 : m[d] >= n ? 1 : 0);
      m[d] -= p.step[d] * n;
    }
    p.touched = around.at(p.step);
    if (p.touched >= 0) p.set = label(static_cast<std::size_t>(p.touched), m);
    if (p.touched == Neighbourhood::interior) p.set = 0;
    return p;
  }

  // Counts the nodes of each set that belong to a lattice cube with all corners in the solid, cubes that reach into
  // neighbouring spans included: an erosion by one step along each axis, then a dilation.
  void count_thick_nodes(Neighbourhood& around, std::size_t t, std::int32_t* set_size) const {
    const std::int64_t n = nodes_.per_span(), wide = n + 2;
    std::array<std::uint8_t, (max_degree + 4) * (max_degree + 4) * (max_degree + 4)> in;
    std::int64_t q = 0;
    Index3 m;
    for (m[2] = -1; m[2] <= n; ++m[2])
      for (m[1] = -1; m[1] <= n; ++m[1])
        for (m[0] = -1; m[0] <= n; ++m[0]) in[static_cast<std::size_t>(q++)] = place(around, m).set != no_set;
    const auto last = static_cast<std::size_t>(q);
    for (const std::int64_t step : {std::int64_t{1}, wide, wide * wide}) {
      const auto stride = static_cast<std::size_t>(step);
      // Entries at the far side wrap round; they are corners of cubes beyond the span's nodes and are never read.
      for (std::size_t i = 0; i + stride < last; ++i) in[i] &= in[i + stride];
    }
    for (const std::int64_t step : {std::int64_t{1}, wide, wide * wide}) {
      const auto stride = static_cast<std::size_t>(step);
      for (std::size_t i = last - 1; i >= stride; --i) in[i] |= in[i - stride];
    }
    for (m[2] = 0; m[2] < n; ++m[2])
      for (m[1] = 0; m[1] < n; ++m[1])
        for (m[0] = 0; m[0] < n; ++m[0]) {
          const std::uint8_t set = label(t, m);
          if (set != no_set)
            set_size[set] += in[static_cast<std::size_t>(m[0] + 1 + wide * (m[1] + 1 + wide * (m[2] + 1)))];
        }
  }

  void link_span(std::size_t t, std::vector<NodeLink>& links, std::int32_t* set_size) const {
    Neighbourhood around(grid_, pieces_, state_, t);
    count_thick_nodes(around, t, set_size);
    const std::size_t before = links.size();
    const auto add = [&](const Place& to, std::uint8_t own) {
      const auto same = [&](const NodeLink& l) { return l.own == own && l.other == to.set && l.step == to.step; };
      if (std::none_of(links.begin() + static_cast<std::ptrdiff_t>(before), links.end(), same))
        links.push_back({to.step, own, to.set});
    };
    const std::int64_t n = nodes_.per_span();
    Index3 m;
    for (m[2] = 0; m[2] < n; ++m[2])
      for (m[1] = 0; m[1] < n; ++m[1])
        for (m[0] = 0; m[0] < n; ++m[0]) {
          const std::uint8_t own = label(t, m);
          if (own == no_set) continue;
          for (std::size_t d = 0; d < 3; ++d) {
            if (m[d] == n - 1) link_up(around, t, m, d, [&](const Place& to) { add(to, own); });
            if (m[d] == 0) link_down(around, t, m, d, [&](const Place& to) { add(to, own); });
            link_diagonals(around, t, m, own, (d + 1) % 3, (d + 2) % 3, [&](const Place& to) { add(to, own); });
          }
        }
  }

  // Along a line to the upper neighbour.
  template <class Add>
  void link_up(Neighbourhood& around, std::size_t t, const Index3& m, std::size_t axis, Add&& add) const {
    Index3 next = m, segment = m;
    ++next[axis];
    const Place to = place(around, next);
    segment[axis] = nodes_.per_span();
    if (to.set == no_set || nodes_.blocked(t, axis, segment)) return;
    segment[axis] = 0;
    if (to.touched >= 0 && nodes_.blocked(static_cast<std::size_t>(to.touched), axis, segment)) return;
    add(to);
  }

  // To the lower neighbour only where it has no surface and hence no links of its own.
  template <class Add>
  void link_down(Neighbourhood& around, std::size_t t, const Index3& m, std::size_t axis, Add&& add) const {
    Index3 next = m;
    --next[axis];
    const Place to = place(around, next);
    if (to.touched == Neighbourhood::interior && !nodes_.blocked(t, axis, m)) add(to);
  }

  template <class Add>
  void link_diagonals(Neighbourhood& around, std::size_t t, const Index3& m, std::uint8_t own, std::size_t e,
                      std::size_t f, Add&& add) const {
    for (const std::int64_t se : {1, -1}) {
      Index3 b = m;
      b[e] += se;
      const Place beside_e = place(around, b);
      if (beside_e.set != no_set) continue;
      for (const std::int64_t sf : {1, -1}) {
        Index3 d = m, c = b;
        d[f] += sf;
        c[f] += sf;
        const Place beside_f = place(around, d);
        if (beside_f.set != no_set) continue;
        const Place to = place(around, c);
        if (to.set == no_set || (to.touched == static_cast<std::int64_t>(t) && to.set == own)) continue;
        if (se < 0 && to.touched >= 0) continue; // found from the other end
        const auto own_span = static_cast<std::int64_t>(t);
        if (free_segment(around, m, c, {own_span, beside_e.touched, beside_f.touched, to.touched})) add(to);
      }
    }
  }

  Point3 position(const Neighbourhood& around, const Index3& m) const {
    Point3 xi;
    for (std::size_t d = 0; d < 3; ++d)
      xi[d] = nodes_.lattice().coordinate(d, around.index()[d] * nodes_.per_span() + m[d]);
    return xi;
  }

  // Whether no piece of these spans lies between two nodes.
  bool free_segment(const Neighbourhood& around, const Index3& from, const Index3& to,
                    const std::array<std::int64_t, 4>& touched) const {
    const Point3 p = position(around, from), q = position(around, to);
    for (std::size_t s = 0; s < touched.size(); ++s) {
      if (touched[s] < 0 || std::find(touched.begin(), touched.begin() + static_cast<std::ptrdiff_t>(s), touched[s]) !=
                                touched.begin() + static_cast<std::ptrdiff_t>(s))
        continue;
      const auto t = static_cast<std::size_t>(touched[s]);
      for (auto piece = pieces_.offsets[t]; piece < pieces_.offsets[t + 1]; ++piece)
        if (meets(p, q, pieces_.polygon(piece))) return false;
    }
    return true;
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  const std::vector<std::uint8_t>& state_;
  const LatticeNodes& nodes_;
  std::vector<std::uint8_t> labels_; // (num_touched × nodes per span)
};

} // namespace

NodeSets build_node_sets(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
                         const LatticeNodes& nodes) {
  return NodeSetBuilder(grid, pieces, state, nodes).build();
}

} // namespace iga::prep
