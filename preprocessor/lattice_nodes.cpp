// Two levels: connected sets of nodes inside each span, then the links between the sets of neighbouring spans. A
// function's support is a block of spans, so its connected sets follow from a few dozen links.
#include "preprocessor/lattice_nodes.hpp"

#include "format/model/span_state.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace iga::prep {

namespace {

constexpr std::uint8_t no_set = 255;  // at most n³ / 2 = 108 sets: isolated nodes of a chessboard at degree 4
constexpr std::size_t spans_per_block = 1024;

struct Link {
  std::uint8_t axis = 0;
  bool upwards = true;       ///< false: to the lower neighbour, stored only where that one is not touched
  std::uint8_t own = 0;      ///< set of this span
  std::uint8_t other = 0;    ///< set of the neighbour
};

/// Sets of all touched spans and the links between them.
struct SetGraph {
  std::vector<std::int64_t> first_set;   ///< (num_touched + 1)
  std::vector<std::int32_t> set_size;    ///< (num_sets); nodes
  std::vector<std::int64_t> first_link;  ///< (num_touched + 1)
  std::vector<Link> links;
};

// Labels the connected sets of one span by flood filling; appends their sizes.
void label_span(const LatticeNodes& nodes, std::size_t t, std::uint8_t* labels, std::vector<std::int32_t>& sizes) {
  const std::int64_t n = nodes.per_span();
  std::fill(labels, labels + nodes.nodes_per_span(), no_set);
  std::uint8_t next = 0;
  std::vector<Index3> stack;
  Index3 seed;
  for (seed[2] = 0; seed[2] < n; ++seed[2])
    for (seed[1] = 0; seed[1] < n; ++seed[1])
      for (seed[0] = 0; seed[0] < n; ++seed[0]) {
        if (labels[nodes.node(seed)] != no_set || !nodes.inside(t, nodes.node(seed))) continue;
        std::int32_t size = 0;
        labels[nodes.node(seed)] = next;
        stack.push_back(seed);
        while (!stack.empty()) {
          const Index3 m = stack.back();
          stack.pop_back();
          ++size;
          for (std::size_t d = 0; d < 3; ++d)
            for (const std::int64_t step : {-1, 1}) {
              Index3 to = m, segment = m;
              to[d] += step;
              if (to[d] < 0 || to[d] >= n) continue;
              segment[d] = std::max(m[d], to[d]);
              const std::int64_t node = nodes.node(to);
              if (labels[node] != no_set || !nodes.inside(t, node) || nodes.blocked(t, d, segment)) continue;
              labels[node] = next;
              stack.push_back(to);
            }
        }
        sizes.push_back(size);
        ++next;
      }
}

class SetGraphBuilder {
public:
  SetGraphBuilder(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
                  const LatticeNodes& nodes)
      : grid_(grid), pieces_(pieces), state_(state), nodes_(nodes) {}

  SetGraph build() {
    const std::size_t num_touched = pieces_.spans.size();
    const std::size_t num_blocks = (num_touched + spans_per_block - 1) / spans_per_block;
    const auto volume = static_cast<std::size_t>(nodes_.nodes_per_span());
    labels_.resize(num_touched * volume);
    SetGraph graph;
    graph.first_set.assign(num_touched + 1, 0);
    graph.first_link.assign(num_touched + 1, 0);
    std::vector<std::vector<std::int32_t>> sizes(num_blocks);
    std::vector<std::vector<Link>> links(num_blocks);
    const auto for_blocks = [&](auto&& work) {
      tbb::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t b) {
        for (std::size_t t = b * spans_per_block; t < std::min((b + 1) * spans_per_block, num_touched); ++t) work(b, t);
      });
    };
    for_blocks([&](std::size_t b, std::size_t t) {
      const std::size_t before = sizes[b].size();
      label_span(nodes_, t, &labels_[t * volume], sizes[b]);
      graph.first_set[t + 1] = static_cast<std::int64_t>(sizes[b].size() - before);
    });
    for_blocks([&](std::size_t b, std::size_t t) {
      const std::size_t before = links[b].size();
      link_span(t, links[b]);
      graph.first_link[t + 1] = static_cast<std::int64_t>(links[b].size() - before);
    });
    for (std::size_t t = 0; t < num_touched; ++t) {
      graph.first_set[t + 1] += graph.first_set[t];
      graph.first_link[t + 1] += graph.first_link[t];
    }
    for (std::size_t b = 0; b < num_blocks; ++b) {
      graph.set_size.insert(graph.set_size.end(), sizes[b].begin(), sizes[b].end());
      graph.links.insert(graph.links.end(), links[b].begin(), links[b].end());
    }
    return graph;
  }

private:
  std::uint8_t label(std::size_t t, const Index3& m) const {
    return labels_[t * static_cast<std::size_t>(nodes_.nodes_per_span()) + static_cast<std::size_t>(nodes_.node(m))];
  }

  // Links through one face of a span; `up` towards higher numbers.
  void link_face(std::size_t t, const Index3& ijk, std::size_t axis, bool up, std::vector<Link>& links) const {
    Index3 neighbour = ijk;
    neighbour[axis] += up ? 1 : -1;
    if (neighbour[axis] < 0 || neighbour[axis] >= grid_.spans()[axis]) return;
    const std::int64_t span = grid_.span_number(neighbour);
    const auto found = std::lower_bound(pieces_.spans.begin(), pieces_.spans.end(), span);
    const bool touched = found != pieces_.spans.end() && *found == span;
    if (touched && !up) return;
    if (!touched && state_[static_cast<std::size_t>(span)] != static_cast<std::uint8_t>(SpanState::Interior)) return;
    const auto t2 = static_cast<std::size_t>(found - pieces_.spans.begin());
    const std::size_t e = (axis + 1) % 3, f = (axis + 2) % 3;
    const std::int64_t n = nodes_.per_span();
    const std::size_t before = links.size();
    Index3 m{};
    for (m[f] = 0; m[f] < n; ++m[f])
      for (m[e] = 0; m[e] < n; ++m[e]) {
        m[axis] = up ? n - 1 : 0;
        const std::uint8_t own = label(t, m);
        if (own == no_set) continue;
        m[axis] = up ? n : 0;
        if (nodes_.blocked(t, axis, m)) continue;
        std::uint8_t other = 0;
        if (touched) {
          m[axis] = 0;
          other = label(t2, m);
          if (other == no_set || nodes_.blocked(t2, axis, m)) continue;
        }
        const auto same = [&](const Link& l) { return l.own == own && l.other == other; };
        if (std::none_of(links.begin() + static_cast<std::ptrdiff_t>(before), links.end(), same))
          links.push_back({static_cast<std::uint8_t>(axis), up, own, other});
      }
  }

  void link_span(std::size_t t, std::vector<Link>& links) const {
    const Index3 ijk = grid_.span_index(pieces_.spans[t]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      link_face(t, ijk, axis, true, links);
      link_face(t, ijk, axis, false, links);
    }
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  const std::vector<std::uint8_t>& state_;
  const LatticeNodes& nodes_;
  std::vector<std::uint8_t> labels_;  // (num_touched × nodes per span)
};

/// Sets that can be joined (union-find with path halving), each with its number of nodes.
struct JoinedSets {
  std::vector<std::int32_t> parent, size;

  void clear() {
    parent.clear();
    size.clear();
  }
  void add(std::int32_t nodes) {
    parent.push_back(static_cast<std::int32_t>(parent.size()));
    size.push_back(nodes);
  }
  std::int32_t root(std::int32_t a) {
    auto p = static_cast<std::size_t>(a);
    while (parent[p] != static_cast<std::int32_t>(p)) {
      parent[p] = parent[static_cast<std::size_t>(parent[p])];
      p = static_cast<std::size_t>(parent[p]);
    }
    return static_cast<std::int32_t>(p);
  }
  void join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    parent[static_cast<std::size_t>(b)] = a;
    size[static_cast<std::size_t>(a)] += size[static_cast<std::size_t>(b)];
  }
  std::int64_t count_roots(std::int32_t smallest) const {
    std::int64_t count = 0;
    for (std::size_t a = 0; a < parent.size(); ++a)
      count += parent[a] == static_cast<std::int32_t>(a) && size[a] >= smallest;
    return count;
  }
};

/// Judges the functions of one row (fixed j, k), i ascending.
class FunctionRow {
public:
  FunctionRow(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
              const SetGraph& graph, const std::vector<std::int64_t>& row_first, std::int32_t nodes_per_span)
      : grid_(grid), pieces_(pieces), state_(state), graph_(graph), row_first_(row_first), volume_(nodes_per_span) {}

  GluedFunctions judge(std::int64_t j, std::int64_t k) {
    const Index3 n = grid_.spans();
    const auto p = grid_.degree();
    low_ = {0, std::max<std::int64_t>(j - p[1], 0), std::max<std::int64_t>(k - p[2], 0)};
    high_ = {0, std::min(j, n[1] - 1), std::min(k, n[2] - 1)};
    cursor_.clear();
    for (std::int64_t c = low_[2]; c <= high_[2]; ++c)
      for (std::int64_t b = low_[1]; b <= high_[1]; ++b) {
        const auto row = static_cast<std::size_t>(b + n[1] * c);
        cursor_.push_back({row_first_[row], row_first_[row + 1]});
      }
    GluedFunctions out;
    for (std::int64_t i = 0; i < n[0] + p[0];) {
      low_[0] = std::max<std::int64_t>(i - p[0], 0);
      high_[0] = std::min(i, n[0] - 1);
      const std::int64_t next = next_touched();
      if (next < 0) break;
      if (next > high_[0]) {
        i = next;
        continue;
      }
      if (glued()) {
        if (out.count++ == 0) out.first = grid_.function_number({i, j, k});
      }
      ++i;
    }
    return out;
  }

private:
  struct Cursor {
    std::int64_t first, last;  // touched spans of the row that may still matter
  };

  std::int64_t span_u(std::int64_t t) const { return pieces_.spans[static_cast<std::size_t>(t)] % grid_.spans()[0]; }

  // Smallest u index >= low_[0] of a touched span in the support's rows, -1 where there is none.
  std::int64_t next_touched() {
    std::int64_t next = -1;
    for (Cursor& c : cursor_) {
      while (c.first < c.last && span_u(c.first) < low_[0]) ++c.first;
      if (c.first < c.last && (next < 0 || span_u(c.first) < next)) next = span_u(c.first);
    }
    return next;
  }

  bool glued() {
    collect_sets();
    if (sets_.parent.size() < 2) return false;
    join_links();
    return sets_.count_roots(std::max(volume_ / 4, 2)) > 1;
  }

  void collect_sets() {
    sets_.clear();
    base_.clear();
    touched_.clear();
    std::size_t row = 0;
    for (std::int64_t c = low_[2]; c <= high_[2]; ++c)
      for (std::int64_t b = low_[1]; b <= high_[1]; ++b, ++row) {
        std::int64_t t = cursor_[row].first;
        for (std::int64_t a = low_[0]; a <= high_[0]; ++a) {
          base_.push_back(static_cast<std::int32_t>(sets_.parent.size()));
          if (t < cursor_[row].last && span_u(t) == a) {
            const auto s = static_cast<std::size_t>(t++);
            for (auto q = graph_.first_set[s]; q < graph_.first_set[s + 1]; ++q)
              sets_.add(graph_.set_size[static_cast<std::size_t>(q)]);
            touched_.push_back(static_cast<std::int64_t>(s));
          } else {
            const bool interior = state_[static_cast<std::size_t>(grid_.span_number({a, b, c}))] ==
                                  static_cast<std::uint8_t>(SpanState::Interior);
            if (interior) sets_.add(volume_);
            touched_.push_back(interior ? -1 : -2);
          }
        }
      }
  }

  void join_links() {
    const Index3 size{high_[0] - low_[0] + 1, high_[1] - low_[1] + 1, high_[2] - low_[2] + 1};
    const Index3 stride{1, size[0], size[0] * size[1]};
    Index3 m;
    std::size_t s = 0;
    for (m[2] = 0; m[2] < size[2]; ++m[2])
      for (m[1] = 0; m[1] < size[1]; ++m[1])
        for (m[0] = 0; m[0] < size[0]; ++m[0], ++s) {
          if (touched_[s] == -1) {
            for (std::size_t d = 0; d < 3; ++d)
              if (m[d] + 1 < size[d] && touched_[s + static_cast<std::size_t>(stride[d])] == -1)
                sets_.join(base_[s], base_[s + static_cast<std::size_t>(stride[d])]);
          } else if (touched_[s] >= 0) {
            const auto t = static_cast<std::size_t>(touched_[s]);
            for (auto q = graph_.first_link[t]; q < graph_.first_link[t + 1]; ++q) {
              const Link& l = graph_.links[static_cast<std::size_t>(q)];
              const std::int64_t to = m[l.axis] + (l.upwards ? 1 : -1);
              if (to < 0 || to >= size[l.axis]) continue;
              const auto other = static_cast<std::size_t>(static_cast<std::int64_t>(s) +
                                                          (l.upwards ? stride[l.axis] : -stride[l.axis]));
              sets_.join(base_[s] + l.own, base_[other] + l.other);
            }
          }
        }
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  const std::vector<std::uint8_t>& state_;
  const SetGraph& graph_;
  const std::vector<std::int64_t>& row_first_;
  std::int32_t volume_;
  Index3 low_{}, high_{};             // the support's spans
  std::vector<Cursor> cursor_;        // per row of the support
  JoinedSets sets_;
  std::vector<std::int32_t> base_;    // first set of each span of the support
  std::vector<std::int64_t> touched_; // its touched number; -1 interior, -2 exterior
};

} // namespace

LatticeNodes::LatticeNodes(std::int64_t num_touched, LineLattice lattice) : n_(lattice.per_span) {
  const std::int64_t bits = n_ * n_ * n_ + 3 * n_ * n_ * (n_ + 1);
  stride_ = static_cast<std::size_t>((bits + 63) / 64);
  words_.assign(static_cast<std::size_t>(num_touched) * stride_, 0);
}

GluedFunctions find_glued_functions(const SplineGrid& grid, const SurfacePieces& pieces,
                                    const std::vector<std::uint8_t>& state, const LatticeNodes& nodes) {
  const SetGraph graph = SetGraphBuilder(grid, pieces, state, nodes).build();
  const Index3 n = grid.spans(), functions = grid.functions();
  std::vector<std::int64_t> row_first(static_cast<std::size_t>(n[1] * n[2]) + 1, 0);  // touched spans of row (j, k)
  for (const std::int64_t span : pieces.spans) ++row_first[static_cast<std::size_t>(span / n[0]) + 1];
  std::partial_sum(row_first.begin(), row_first.end(), row_first.begin());

  const auto num_rows = static_cast<std::size_t>(functions[1] * functions[2]);
  std::vector<GluedFunctions> rows(num_rows);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_rows, 16), [&](const auto& range) {
    FunctionRow row(grid, pieces, state, graph, row_first, static_cast<std::int32_t>(nodes.nodes_per_span()));
    for (std::size_t r = range.begin(); r != range.end(); ++r)
      rows[r] = row.judge(static_cast<std::int64_t>(r) % functions[1], static_cast<std::int64_t>(r) / functions[1]);
  });
  GluedFunctions out;
  for (const GluedFunctions& row : rows) {
    if (out.count == 0) out.first = row.first;
    out.count += row.count;
  }
  return out;
}

} // namespace iga::prep
