// A function's support is a block of spans, so its connected sets of nodes follow from those of the spans and a few
// dozen links between them.
#include "preprocessor/connectivity/shared_functions.hpp"

#include "format/model/span_state.hpp"
#include "preprocessor/connectivity/node_sets.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace iga::prep {

namespace {

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
              const NodeSets& graph, const std::vector<std::int64_t>& row_first, std::int32_t nodes_per_span)
      : grid_(grid), pieces_(pieces), state_(state), graph_(graph), row_first_(row_first), volume_(nodes_per_span) {}

  SharedFunctions judge(std::int64_t j, std::int64_t k) {
    const Index3 n = grid_.spans();
    const auto p = grid_.degree();
    low_ = {0, std::max<std::int64_t>(j - p[1], 0), std::max<std::int64_t>(k - p[2], 0)};
    high_ = {0, std::min(j, n[1] - 1), std::min(k, n[2] - 1)};
    cursor_.clear();
    for (std::int64_t c = low_[2]; c <= high_[2]; ++c)
      for (std::int64_t b = low_[1]; b <= high_[1]; ++b) {
        const auto row = static_cast<std::size_t>(b + n[1] * c);
        cursor_.push_back({row_first_[row], row_first_[row + 1], grid_.span_number({0, b, c})});
      }
    SharedFunctions out;
    for (std::int64_t i = 0; i < n[0] + p[0];) {
      low_[0] = std::max<std::int64_t>(i - p[0], 0);
      high_[0] = std::min(i, n[0] - 1);
      const std::int64_t next = next_touched();
      if (next < 0) break;
      if (next > high_[0]) {
        i = next;
        continue;
      }
      if (is_shared()) {
        if (out.count++ == 0) out.first = grid_.function_number({i, j, k});
      }
      ++i;
    }
    return out;
  }

 private:
  struct Cursor {
    std::int64_t first, last; // touched spans of the row that may still matter
    std::int64_t row_start;   // linear number of the row's first span
  };

  std::int64_t span(std::int64_t t) const { return pieces_.spans[static_cast<std::size_t>(t)]; }

  // Smallest u index >= low_[0] of a touched span in the support's rows, -1 where there is none.
  std::int64_t next_touched() {
    std::int64_t next = -1;
    for (Cursor& c : cursor_) {
      while (c.first < c.last && span(c.first) < c.row_start + low_[0]) ++c.first;
      if (c.first < c.last && (next < 0 || span(c.first) - c.row_start < next)) next = span(c.first) - c.row_start;
    }
    return next;
  }

  bool is_shared() {
    collect_sets();
    if (sets_.parent.size() < 2) return false;
    join_links();
    return sets_.count_roots(std::max(volume_ / 4, 2)) > 1;
  }

  void collect_sets() {
    sets_.clear();
    base_.clear();
    touched_.clear();
    for (const Cursor& row : cursor_) {
      std::int64_t t = row.first;
      for (std::int64_t number = row.row_start + low_[0]; number <= row.row_start + high_[0]; ++number) {
        base_.push_back(static_cast<std::int32_t>(sets_.parent.size()));
        if (t < row.last && span(t) == number) {
          const auto s = static_cast<std::size_t>(t++);
          for (auto q = graph_.first_set[s]; q < graph_.first_set[s + 1]; ++q)
            sets_.add(graph_.set_size[static_cast<std::size_t>(q)]);
          touched_.push_back(static_cast<std::int64_t>(s));
        } else {
          const bool interior =
              state_[static_cast<std::size_t>(number)] == static_cast<std::uint8_t>(SpanState::Interior);
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
              const NodeLink& l = graph_.links[static_cast<std::size_t>(q)];
              auto other = static_cast<std::int64_t>(s);
              bool in_support = true;
              for (std::size_t d = 0; d < 3; ++d) {
                in_support = in_support && m[d] + l.step[d] >= 0 && m[d] + l.step[d] < size[d];
                other += l.step[d] * stride[d];
              }
              if (in_support) sets_.join(base_[s] + l.own, base_[static_cast<std::size_t>(other)] + l.other);
            }
          }
        }
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  const std::vector<std::uint8_t>& state_;
  const NodeSets& graph_;
  const std::vector<std::int64_t>& row_first_;
  std::int32_t volume_;
  Index3 low_{}, high_{};      // the support's spans
  std::vector<Cursor> cursor_; // per row of the support
  JoinedSets sets_;
  std::vector<std::int32_t> base_;    // first set of each span of the support
  std::vector<std::int64_t> touched_; // its touched number; -1 interior, -2 exterior
};

} // namespace

SharedFunctions find_shared_functions(const SplineGrid& grid, const SurfacePieces& pieces,
                                      const std::vector<std::uint8_t>& state, const LatticeNodes& nodes) {
  const NodeSets graph = build_node_sets(grid, pieces, state, nodes);
  const Index3 n = grid.spans(), functions = grid.functions();
  std::vector<std::int64_t> row_first(static_cast<std::size_t>(n[1] * n[2]) + 1, 0); // touched spans of row (j, k)
  for (const std::int64_t span : pieces.spans) ++row_first[static_cast<std::size_t>(span / n[0]) + 1];
  std::partial_sum(row_first.begin(), row_first.end(), row_first.begin());

  const auto num_rows = static_cast<std::size_t>(functions[1] * functions[2]);
  std::vector<SharedFunctions> rows(num_rows);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_rows, 16), [&](const auto& range) {
    FunctionRow row(grid, pieces, state, graph, row_first, static_cast<std::int32_t>(nodes.nodes_per_span()));
    for (std::size_t r = range.begin(); r != range.end(); ++r)
      rows[r] = row.judge(static_cast<std::int64_t>(r) % functions[1], static_cast<std::int64_t>(r) / functions[1]);
  });
  SharedFunctions out;
  for (const SharedFunctions& row : rows) {
    if (out.count == 0) out.first = row.first;
    out.count += row.count;
  }
  return out;
}

} // namespace iga::prep
