#include "solver/multigrid/block_rows.hpp"

#include <algorithm>
#include <cmath>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

std::size_t at(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

using Terms = std::pair<std::int64_t, std::int64_t>;
Terms terms_of(const Transfer& transfer, std::int64_t row) {
  return {transfer.offsets[at(row)], transfer.offsets[at(row) + 1]};
}

// Items 0 … count - 1 in chunks. Greedy: each chunk joins the first group in which none of its neighbours is.
// @param for_neighbours  for_neighbours(i, visit): items that i has to do with
template <class ForNeighbours> Groups grouped(std::int64_t count, std::int64_t length, ForNeighbours for_neighbours) {
  const std::int64_t chunks = (count + length - 1) / length;
  std::vector<std::vector<std::int32_t>> neighbours(at(chunks));
  tbb::parallel_for(std::int64_t{0}, chunks, [&](std::int64_t c) {
    std::vector<char> seen(at(chunks), 0);
    for (std::int64_t i = c * length; i < std::min(count, (c + 1) * length); ++i)
      for_neighbours(i, [&](std::int64_t j) { seen[at(j / length)] = 1; });
    for (std::int64_t other = 0; other < chunks; ++other)
      if (seen[at(other)] && other != c) neighbours[at(c)].push_back(static_cast<std::int32_t>(other));
  });
  std::vector<std::vector<std::int32_t>> groups;
  std::vector<std::int32_t> group_of(neighbours.size(), -1);
  for (std::size_t c = 0; c < neighbours.size(); ++c) {
    std::vector<char> taken(groups.size() + 1, 0);
    for (const std::int32_t other : neighbours[c])
      if (group_of[at(other)] >= 0) taken[at(group_of[at(other)])] = 1;
    const auto group = static_cast<std::size_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
    if (group == groups.size()) groups.emplace_back();
    groups[group].push_back(static_cast<std::int32_t>(c));
    group_of[c] = static_cast<std::int32_t>(group);
  }
  Groups all;
  all.offsets.push_back(0);
  for (const auto& group : groups) {
    for (const std::int32_t c : group)
      all.chunks.emplace_back(static_cast<std::int32_t>(c * length),
                              static_cast<std::int32_t>(std::min(count, (c + 1) * length)));
    all.offsets.push_back(static_cast<std::int64_t>(all.chunks.size()));
  }
  return all;
}

template <class Work> void for_groups(const Groups& groups, Work work) {
  for (std::size_t g = 0; g + 1 < groups.offsets.size(); ++g)
    tbb::parallel_for(groups.offsets[g], groups.offsets[g + 1], [&](std::int64_t c) {
      work(std::int64_t{groups.chunks[at(c)].first}, std::int64_t{groups.chunks[at(c)].second});
    });
}

// Marks of a thread: position of each column in the row at hand, -1 elsewhere.
struct Marks {
  std::vector<std::int32_t> position, columns;
  explicit Marks(std::size_t n) : position(n, -1) {}
  void add(std::int32_t column) {
    if (position[at(column)] >= 0) return;
    position[at(column)] = 0;
    columns.push_back(column);
  }
  void sort() {
    std::sort(columns.begin(), columns.end());
    for (std::size_t k = 0; k < columns.size(); ++k) position[at(columns[k])] = static_cast<std::int32_t>(k);
  }
  void clear() {
    for (const std::int32_t column : columns) position[at(column)] = -1;
    columns.clear();
  }
};

std::shared_ptr<const RowPattern> packed(const std::vector<std::vector<std::int32_t>>& rows) {
  auto pattern = std::make_shared<RowPattern>();
  pattern->offsets.push_back(0);
  for (const auto& row : rows)
    pattern->offsets.push_back(pattern->offsets.back() + static_cast<std::int64_t>(row.size()));
  pattern->columns.resize(at(pattern->offsets.back()));
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    std::copy(rows[i].begin(), rows[i].end(), pattern->columns.begin() + pattern->offsets[i]);
  });
  return pattern;
}

template <int Entry> void add_scaled(double factor, const double* from, double* to) {
  for (int e = 0; e < Entry; ++e) to[e] += factor * from[e];
}

template <int Entry> constexpr int transposed_entry(int e) {
  return Entry == 1 ? 0 : 3 * (e % 3) + e / 3;
}

// C = T + Tᵀ with T = Pᵀ (D / 2 + U) P, U the blocks right of the diagonal D.
template <int Entry, class Matrix>
BlockRows<double, Entry> galerkin(const Matrix& A, const Transfer& P, const Transfer& transpose,
                                  std::shared_ptr<const RowPattern> pattern) {
  BlockRows<double, Entry> C;
  const auto n = static_cast<std::size_t>(P.num_coarse);
  C.values = RawArray<double>(at(Entry * pattern->num_entries()));
  C.pattern = std::move(pattern);
  const RowPattern& rows = *C.pattern;
  double* const T = C.values.data();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 256), [&](const tbb::blocked_range<std::size_t>& range) {
    std::fill(T + Entry * rows.offsets[range.begin()], T + Entry * rows.offsets[range.end()], 0.0);
  });
  struct Work {
    explicit Work(std::size_t size) : marks(size) {}
    Marks marks;
    std::vector<double> sum;
  };
  tbb::enumerable_thread_specific<Work> works([&] { return Work(n); });
  for_groups(independent_rows(P, transpose), [&](std::int64_t first, std::int64_t last) {
    Work& work = works.local();
    Marks& marks = work.marks;
    std::vector<double>& sum = work.sum;
    for (std::int64_t i = first; i < last; ++i) {
      A.upper(i, [&](std::int32_t j, const double*) {
        for (auto [t, end] = terms_of(P, j); t < end; ++t) marks.add(P.nodes[at(t)]);
      });
      marks.sort();
      sum.assign(Entry * marks.columns.size(), 0.0);
      A.upper(i, [&](std::int32_t j, const double* block) {
        const double share = j == i ? 0.5 : 1;
        for (auto [t, end] = terms_of(P, j); t < end; ++t)
          add_scaled<Entry>(share * P.weights[at(t)], block, sum.data() + Entry * marks.position[at(P.nodes[at(t)])]);
      });
      for (auto [t, end] = terms_of(P, i); t < end; ++t) {
        const auto J = at(P.nodes[at(t)]);
        const std::int32_t* column = rows.columns.data() + rows.offsets[J];
        for (std::size_t k = 0; k < marks.columns.size(); ++k) {
          while (*column != marks.columns[k]) ++column;
          add_scaled<Entry>(P.weights[at(t)], sum.data() + Entry * k, T + Entry * (column - rows.columns.data()));
        }
      }
      marks.clear();
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 64), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t J = range.begin(); J < range.end(); ++J)
      for (auto k = rows.offsets[J]; k < rows.offsets[J + 1]; ++k) {
        const auto K = at(rows.columns[at(k)]);
        if (K < J) continue;
        const auto other = std::lower_bound(rows.columns.begin() + rows.offsets[K],
                                            rows.columns.begin() + rows.offsets[K + 1], static_cast<std::int32_t>(J)) -
                           rows.columns.begin();
        double both[Entry];
        for (int e = 0; e < Entry; ++e) both[e] = T[Entry * k + e] + T[Entry * other + transposed_entry<Entry>(e)];
        for (int e = 0; e < Entry; ++e) {
          T[Entry * k + e] = both[e];
          T[Entry * other + transposed_entry<Entry>(e)] = both[e];
        }
      }
  });
  return C;
}

// Whole rows seen as ShiftedStiffness and MassRows are.
template <int Entry> struct UpperRows {
  const BlockRows<double, Entry>& rows;
  template <class Visit> void upper(std::int64_t j, Visit visit) const {
    const RowPattern& p = *rows.pattern;
    for (auto k = p.offsets[at(j)]; k < p.offsets[at(j) + 1]; ++k)
      if (p.columns[at(k)] >= j) visit(p.columns[at(k)], rows.values.data() + Entry * k);
  }
};

template <class Matrix> std::vector<double> scale_of(const Matrix& A, std::int64_t n) {
  std::vector<double> scale(at(n), 1.0);
  tbb::parallel_for(std::int64_t{0}, n, [&](std::int64_t j) {
    A.upper(j, [&](std::int32_t i, const double* block) {
      if (i != j) return;
      const double mean = (block[0] + block[4] + block[8]) / 3;
      if (mean > 0) scale[at(j)] = 1 / std::sqrt(mean);
    });
  });
  return scale;
}

} // namespace

std::shared_ptr<const RowPattern> row_pattern(const NodePattern& lower) {
  auto pattern = std::make_shared<RowPattern>();
  const auto n = static_cast<std::size_t>(lower.num_nodes());
  pattern->offsets.assign(n + 1, 0);
  for (std::size_t j = 0; j < n; ++j) {
    pattern->offsets[j + 1] += lower.offsets[j + 1] - lower.offsets[j];
    for (auto k = lower.offsets[j] + 1; k < lower.offsets[j + 1]; ++k) ++pattern->offsets[at(lower.rows[at(k)]) + 1];
  }
  for (std::size_t j = 0; j < n; ++j) pattern->offsets[j + 1] += pattern->offsets[j];
  pattern->columns.resize(at(pattern->offsets[n]));
  std::vector<std::int64_t> next(pattern->offsets.begin(), pattern->offsets.end() - 1);
  for (std::size_t j = 0; j < n; ++j) // columns left of the diagonal come in ascending order, before those right of it
    for (auto k = lower.offsets[j] + 1; k < lower.offsets[j + 1]; ++k)
      pattern->columns[at(next[at(lower.rows[at(k)])]++)] = static_cast<std::int32_t>(j);
  for (std::size_t j = 0; j < n; ++j)
    std::copy(lower.rows.begin() + lower.offsets[j], lower.rows.begin() + lower.offsets[j + 1],
              pattern->columns.begin() + next[j]);
  return pattern;
}

BlockRows<float, 9> scaled_rows(const ShiftedStiffness& A, std::shared_ptr<const RowPattern> pattern,
                                const std::vector<double>& scale) {
  BlockRows<float, 9> rows{pattern, RawArray<float>(at(9 * pattern->num_entries()))};
  float* const values = rows.values.data();
  // The row of a block left of the diagonal is another thread's, its place is nobody else's.
  tbb::parallel_for(
      tbb::blocked_range<std::int64_t>(0, pattern->size(), 256), [&](const tbb::blocked_range<std::int64_t>& range) {
        for (std::int64_t j = range.begin(); j < range.end(); ++j) {
          const auto first = pattern->offsets[at(j)], last = pattern->offsets[at(j) + 1];
          std::int64_t place = std::lower_bound(pattern->columns.begin() + first, pattern->columns.begin() + last,
                                                static_cast<std::int32_t>(j)) -
                               pattern->columns.begin();
          A.upper(j, [&](std::int32_t i, const double* block) {
            const double s = scale[at(i)] * scale[at(j)];
            for (int e = 0; e < 9; ++e) values[9 * place + e] = static_cast<float>(s * block[e]);
            if (i != j) {
              const auto mirror = std::lower_bound(pattern->columns.begin() + pattern->offsets[at(i)],
                                                   pattern->columns.begin() + pattern->offsets[at(i) + 1],
                                                   static_cast<std::int32_t>(j)) -
                                  pattern->columns.begin();
              for (int e = 0; e < 9; ++e)
                values[9 * mirror + transposed_entry<9>(e)] = static_cast<float>(s * block[e]);
            }
            ++place;
          });
        }
      });
  return rows;
}

BlockRows<float, 9> scaled_rows(const BlockRows<double, 9>& A, const std::vector<double>& scale) {
  const RowPattern& p = *A.pattern;
  BlockRows<float, 9> rows{A.pattern, RawArray<float>(at(9 * p.num_entries()))};
  tbb::parallel_for(std::int64_t{0}, p.size(), [&](std::int64_t i) {
    for (auto k = p.offsets[at(i)]; k < p.offsets[at(i) + 1]; ++k) {
      const double s = scale[at(i)] * scale[at(p.columns[at(k)])];
      for (std::int64_t e = 9 * k; e < 9 * k + 9; ++e)
        rows.values.data()[e] = static_cast<float>(s * A.values.data()[e]);
    }
  });
  return rows;
}

std::vector<double> node_scale(const ShiftedStiffness& A) {
  return scale_of(A, A.stiffness->pattern().num_nodes());
}

std::vector<double> node_scale(const BlockRows<double, 9>& A) {
  return scale_of(UpperRows<9>{A}, A.pattern->size());
}

Transfer transposed(const Transfer& transfer) {
  Transfer result;
  const auto n = static_cast<std::size_t>(transfer.num_coarse);
  result.num_coarse = transfer.num_fine();
  result.offsets.assign(n + 1, 0);
  for (const std::int32_t node : transfer.nodes) ++result.offsets[at(node) + 1];
  for (std::size_t j = 0; j < n; ++j) result.offsets[j + 1] += result.offsets[j];
  result.nodes.resize(transfer.nodes.size());
  result.weights.resize(transfer.nodes.size());
  std::vector<std::int64_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::int64_t i = 0; i < transfer.num_fine(); ++i)
    for (auto [t, end] = terms_of(transfer, i); t < end; ++t) {
      const auto place = at(next[at(transfer.nodes[at(t)])]++);
      result.nodes[place] = static_cast<std::int32_t>(i);
      result.weights[place] = transfer.weights[at(t)];
    }
  return result;
}

Groups independent_blocks(const NodeBlocks& blocks, const RowPattern& pattern) {
  std::vector<std::vector<std::int32_t>> blocks_of(at(pattern.size()));
  for (std::int64_t b = 0; b < blocks.size(); ++b)
    for (auto k = blocks.offsets[at(b)]; k < blocks.offsets[at(b) + 1]; ++k)
      blocks_of[at(blocks.nodes[at(k)])].push_back(static_cast<std::int32_t>(b));
  // Long enough that a chunk's neighbours are few, short enough that groups have work for many threads.
  const std::int64_t length = std::clamp<std::int64_t>(blocks.size() / 128, 1, 16);
  return grouped(blocks.size(), length, [&](std::int64_t b, auto visit) {
    for (auto n = blocks.offsets[at(b)]; n < blocks.offsets[at(b) + 1]; ++n) {
      const auto i = at(blocks.nodes[at(n)]);
      for (auto k = pattern.offsets[i]; k < pattern.offsets[i + 1]; ++k)
        for (const std::int32_t other : blocks_of[at(pattern.columns[at(k)])]) visit(std::int64_t{other});
    }
  });
}

Groups independent_rows(const Transfer& transfer, const Transfer& transpose) {
  const std::int64_t n = transfer.num_fine();
  return grouped(n, std::clamp<std::int64_t>(n / 128, 32, 512), [&](std::int64_t i, auto visit) {
    for (auto [t, end] = terms_of(transfer, i); t < end; ++t)
      for (auto [s, last] = terms_of(transpose, transfer.nodes[at(t)]); s < last; ++s)
        visit(std::int64_t{transpose.nodes[at(s)]});
  });
}

std::shared_ptr<const RowPattern> coarse_pattern(const RowPattern& fine, const Transfer& P, const Transfer& transpose) {
  const auto n = static_cast<std::size_t>(P.num_coarse);
  tbb::enumerable_thread_specific<Marks> all_marks([&] { return Marks(n); });
  std::vector<std::vector<std::int32_t>> halfway(at(P.num_fine())), rows(n); // of A P, of Pᵀ A P
  const auto collect = [&](auto for_columns, std::vector<std::int32_t>& row) {
    Marks& marks = all_marks.local();
    for_columns([&](std::int32_t column) { marks.add(column); });
    row.assign(marks.columns.begin(), marks.columns.end());
    marks.clear();
  };
  tbb::parallel_for(std::int64_t{0}, P.num_fine(), [&](std::int64_t i) {
    collect(
        [&](auto visit) {
          for (auto k = fine.offsets[at(i)]; k < fine.offsets[at(i) + 1]; ++k)
            for (auto [t, end] = terms_of(P, fine.columns[at(k)]); t < end; ++t) visit(P.nodes[at(t)]);
        },
        halfway[at(i)]);
  });
  tbb::parallel_for(std::int64_t{0}, P.num_coarse, [&](std::int64_t J) {
    collect(
        [&](auto visit) {
          for (auto [t, end] = terms_of(transpose, J); t < end; ++t)
            for (const std::int32_t K : halfway[at(transpose.nodes[at(t)])]) visit(K);
        },
        rows[at(J)]);
    std::sort(rows[at(J)].begin(), rows[at(J)].end());
  });
  return packed(rows);
}

BlockRows<double, 9> coarse_stiffness(const ShiftedStiffness& A, const Transfer& P, const Transfer& transpose,
                                      std::shared_ptr<const RowPattern> pattern) {
  return galerkin<9>(A, P, transpose, std::move(pattern));
}
BlockRows<double, 9> coarse_stiffness(const BlockRows<double, 9>& A, const Transfer& P, const Transfer& transpose,
                                      std::shared_ptr<const RowPattern> pattern) {
  return galerkin<9>(UpperRows<9>{A}, P, transpose, std::move(pattern));
}
BlockRows<double, 1> coarse_mass(const MassRows& M, const Transfer& P, const Transfer& transpose,
                                 std::shared_ptr<const RowPattern> pattern) {
  return galerkin<1>(M, P, transpose, std::move(pattern));
}
BlockRows<double, 1> coarse_mass(const BlockRows<double, 1>& M, const Transfer& P, const Transfer& transpose,
                                 std::shared_ptr<const RowPattern> pattern) {
  return galerkin<1>(UpperRows<1>{M}, P, transpose, std::move(pattern));
}

} // namespace iga::solve
