#include "preprocessor/connectivity/function_copies.hpp"

#include "format/model/disjoint_sets.hpp"
#include "format/model/errors.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace iga::prep {

namespace {

/// Which copy of a function with several a piece sees.
struct Choice {
  std::int64_t function;
  std::int32_t piece, copy;
  friend bool operator<(const Choice& x, const Choice& y) {
    return x.function != y.function ? x.function < y.function : x.piece < y.piece;
  }
};

class Copier {
 public:
  Copier(const SplineGrid& grid, const std::vector<std::int64_t>& active, const PieceGraph& graph)
      : grid_(grid), active_(active), graph_(graph), active_of_(static_cast<std::size_t>(grid.num_spans()), -1),
        first_link_(static_cast<std::size_t>(graph.first.back()) + 1, 0) {
    for (std::size_t a = 0; a < active.size(); ++a)
      active_of_[static_cast<std::size_t>(active[a])] = static_cast<std::int32_t>(a);
    for (const PieceLink& link : graph.links) ++first_link_[static_cast<std::size_t>(link.low) + 1];
    std::partial_sum(first_link_.begin(), first_link_.end(), first_link_.begin());
  }

  FunctionCopies run() {
    const Index3 n = grid_.functions();
    const auto num_rows = static_cast<std::size_t>(n[1] * n[2]);
    std::vector<std::int32_t> copies(static_cast<std::size_t>(n[0] * n[1] * n[2]), 0);
    choices_.resize(num_rows);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_rows, 16), [&](const auto& range) {
      Support support;
      for (std::size_t r = range.begin(); r != range.end(); ++r)
        for (std::int64_t i = 0; i < n[0]; ++i) {
          const std::int64_t f = i + n[0] * static_cast<std::int64_t>(r);
          copies[static_cast<std::size_t>(f)] = count_copies(f, support, choices_[r]);
        }
    });
    FunctionCopies out;
    const std::int64_t total = std::accumulate(copies.begin(), copies.end(), std::int64_t{0});
    if (total > std::numeric_limits<std::int32_t>::max())
      throw InputError("the grid has more functions than 2^31; choose larger spans");
    out.number.reserve(static_cast<std::size_t>(total));
    for (std::size_t f = 0; f < copies.size(); ++f) {
      const auto count = copies[f];
      copies[f] = static_cast<std::int32_t>(out.number.size()); // now the first copy
      out.number.insert(out.number.end(), static_cast<std::size_t>(count), static_cast<std::int64_t>(f));
    }
    fill(copies, out);
    return out;
  }

 private:
  struct Support {
    std::vector<std::int32_t> base;                        // first piece of each span of the support among those there
    std::vector<std::int32_t> parent, piece, place, copy_; // of each piece: set, number, span of the support
  };

  std::int32_t count_copies(std::int64_t function, Support& s, std::vector<Choice>& choices) const {
    const Index3 i = grid_.function_index(function), n = grid_.spans();
    const auto p = grid_.degree();
    Index3 low, size;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::max<std::int64_t>(i[d] - p[d], 0);
      size[d] = std::min(i[d], n[d] - 1) - low[d] + 1;
    }
    s.base.clear();
    s.piece.clear();
    s.place.clear();
    for (std::int64_t c = 0; c < size[2]; ++c)
      for (std::int64_t b = 0; b < size[1]; ++b)
        for (std::int64_t a = 0; a < size[0]; ++a) {
          const std::int32_t active =
              active_of_[static_cast<std::size_t>(grid_.span_number({low[0] + a, low[1] + b, low[2] + c}))];
          const auto place = static_cast<std::int32_t>(s.base.size());
          s.base.push_back(static_cast<std::int32_t>(s.piece.size()));
          if (active < 0) continue;
          for (auto q = graph_.first[static_cast<std::size_t>(active)];
               q < graph_.first[static_cast<std::size_t>(active) + 1]; ++q) {
            s.piece.push_back(static_cast<std::int32_t>(q));
            s.place.push_back(place);
          }
        }
    if (s.piece.size() < 2) return static_cast<std::int32_t>(s.piece.size());
    s.parent.resize(s.piece.size());
    std::iota(s.parent.begin(), s.parent.end(), 0);
    const Index3 stride{1, size[0], size[0] * size[1]};
    std::size_t sets = s.piece.size();
    for (std::size_t x = 0; x < s.piece.size(); ++x) {
      const auto q = static_cast<std::size_t>(s.piece[x]);
      for (auto l = first_link_[q]; l < first_link_[q + 1]; ++l) {
        const PieceLink& link = graph_.links[static_cast<std::size_t>(l)];
        const auto place = static_cast<std::int64_t>(s.place[x]);
        const std::int64_t along = place / stride[link.axis] % size[link.axis];
        if (along + 1 >= size[link.axis]) continue;
        auto y = static_cast<std::size_t>(s.base[static_cast<std::size_t>(place + stride[link.axis])]);
        while (s.piece[y] != link.high) ++y;
        const auto first = static_cast<std::int32_t>(x), second = static_cast<std::int32_t>(y);
        if (find_root(s.parent, first) == find_root(s.parent, second)) continue;
        join_sets(s.parent, first, second);
        --sets;
      }
      if (sets == 1) return 1;
    }
    s.copy_.assign(s.piece.size(), -1);
    std::int32_t count = 0;
    for (std::size_t x = 0; x < s.piece.size(); ++x) {
      auto& copy = s.copy_[static_cast<std::size_t>(find_root(s.parent, static_cast<std::int32_t>(x)))];
      if (copy < 0) copy = count++;
      choices.push_back({function, s.piece[x], copy});
    }
    return count;
  }

  void fill(const std::vector<std::int32_t>& first_copy, FunctionCopies& out) {
    const auto p = grid_.degree();
    const std::int64_t row_length = grid_.functions()[0];
    const auto local = static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
    out.of_piece.resize(static_cast<std::size_t>(graph_.first.back()) * local);
    for (auto& row : choices_) std::sort(row.begin(), row.end());
    tbb::parallel_for(std::size_t{0}, active_.size(), [&](std::size_t a) {
      const Index3 s = grid_.span_index(active_[a]);
      for (auto q = graph_.first[a]; q < graph_.first[a + 1]; ++q) {
        auto* entry = &out.of_piece[static_cast<std::size_t>(q) * local];
        for (int c = 0; c <= p[2]; ++c)
          for (int b = 0; b <= p[1]; ++b)
            for (int e = 0; e <= p[0]; ++e) {
              const std::int64_t f = grid_.function_number({s[0] + e, s[1] + b, s[2] + c});
              const auto& row = choices_[static_cast<std::size_t>(f / row_length)];
              const Choice wanted{f, static_cast<std::int32_t>(q), 0};
              const auto found = std::lower_bound(row.begin(), row.end(), wanted);
              const bool several = found != row.end() && found->function == f && found->piece == wanted.piece;
              *entry++ = first_copy[static_cast<std::size_t>(f)] + (several ? found->copy : 0);
            }
      }
    });
  }

  const SplineGrid& grid_;
  const std::vector<std::int64_t>& active_;
  const PieceGraph& graph_;
  std::vector<std::int32_t> active_of_;      // (num_spans), -1 for spans without material
  std::vector<std::int64_t> first_link_;     // (num_pieces + 1)
  std::vector<std::vector<Choice>> choices_; // by row of functions
};

} // namespace

FunctionCopies copy_functions(const SplineGrid& grid, const std::vector<std::int64_t>& active,
                              const PieceGraph& graph) {
  return Copier(grid, active, graph).run();
}

} // namespace iga::prep
