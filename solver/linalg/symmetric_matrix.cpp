#include "solver/linalg/symmetric_matrix.hpp"

#include <algorithm>
#include <cassert>
#include <new>
#include <sys/mman.h>
#include <tbb/enumerable_thread_specific.h>

namespace iga::solve {

namespace {

// Spans of each node: the inverse of SolutionSpace::nodes.
struct NodeSpans {
  std::vector<std::int64_t> offsets;
  std::vector<std::int32_t> spans;
};

NodeSpans spans_of_nodes(const SolutionSpace& space) {
  NodeSpans inverse;
  inverse.offsets.assign(static_cast<std::size_t>(space.num_nodes()) + 1, 0);
  for (std::int64_t a = 0; a < space.num_cells(); ++a)
    for (const std::int32_t node : space.nodes(a)) ++inverse.offsets[static_cast<std::size_t>(node) + 1];
  for (std::size_t n = 1; n < inverse.offsets.size(); ++n) inverse.offsets[n] += inverse.offsets[n - 1];
  inverse.spans.resize(static_cast<std::size_t>(inverse.offsets.back()));
  std::vector<std::int64_t> next(inverse.offsets.begin(), inverse.offsets.end() - 1);
  for (std::int64_t a = 0; a < space.num_cells(); ++a)
    for (const std::int32_t node : space.nodes(a))
      inverse.spans[static_cast<std::size_t>(next[static_cast<std::size_t>(node)]++)] = static_cast<std::int32_t>(a);
  return inverse;
}

NodePattern make_pattern(const SolutionSpace& space) {
  const NodeSpans inverse = spans_of_nodes(space);
  const auto n = static_cast<std::size_t>(space.num_nodes());
  std::vector<std::vector<std::int32_t>> columns(n);
  tbb::enumerable_thread_specific<std::vector<std::int32_t>> marks([&] { return std::vector<std::int32_t>(n, -1); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 64), [&](const tbb::blocked_range<std::size_t>& range) {
    auto& mark = marks.local();
    std::vector<std::int32_t> rows;
    for (std::size_t j = range.begin(); j < range.end(); ++j) {
      const auto column = static_cast<std::int32_t>(j);
      rows.assign(1, column); // a node without any span keeps its diagonal
      mark[j] = column;
      for (auto s = inverse.offsets[j]; s < inverse.offsets[j + 1]; ++s)
        for (const std::int32_t i : space.nodes(inverse.spans[static_cast<std::size_t>(s)]))
          if (i > column && mark[static_cast<std::size_t>(i)] != column) {
            mark[static_cast<std::size_t>(i)] = column;
            rows.push_back(i);
          }
      std::sort(rows.begin(), rows.end());
      columns[j].assign(rows.begin(), rows.end());
    }
  });
  NodePattern pattern;
  pattern.offsets.assign(1, 0);
  pattern.offsets.reserve(n + 1);
  for (const auto& column : columns)
    pattern.offsets.push_back(pattern.offsets.back() + static_cast<std::int64_t>(column.size()));
  pattern.rows.resize(static_cast<std::size_t>(pattern.offsets.back()));
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t j) {
    std::copy(columns[j].begin(), columns[j].end(), pattern.rows.begin() + pattern.offsets[j]);
  });
  return pattern;
}

// Patterns of several spaces as one: nodes follow one another.
NodePattern joined(std::vector<NodePattern> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  NodePattern pattern;
  pattern.offsets.assign(1, 0);
  for (const NodePattern& part : parts) {
    const auto first_node = static_cast<std::int32_t>(pattern.num_nodes());
    const std::int64_t first_pair = pattern.num_pairs();
    for (std::size_t j = 1; j < part.offsets.size(); ++j) pattern.offsets.push_back(first_pair + part.offsets[j]);
    for (const std::int32_t row : part.rows) pattern.rows.push_back(first_node + row);
  }
  return pattern;
}

NodePattern with_couples(NodePattern pattern, std::span<const std::vector<std::int32_t>> coupled) {
  if (coupled.empty()) return pattern;
  std::vector<std::vector<std::int32_t>> columns(static_cast<std::size_t>(pattern.num_nodes()));
  for (std::size_t j = 0; j < columns.size(); ++j)
    columns[j].assign(pattern.rows.begin() + pattern.offsets[j], pattern.rows.begin() + pattern.offsets[j + 1]);
  for (const auto& nodes : coupled)
    for (const std::int32_t column : nodes) {
      auto& rows = columns[static_cast<std::size_t>(column)];
      for (const std::int32_t row : nodes)
        if (row > column) rows.push_back(row);
      std::sort(rows.begin(), rows.end());
      rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    }
  NodePattern wider;
  wider.offsets.assign(1, 0);
  for (const auto& rows : columns) {
    wider.rows.insert(wider.rows.end(), rows.begin(), rows.end());
    wider.offsets.push_back(static_cast<std::int64_t>(wider.rows.size()));
  }
  return wider;
}

// Edge of a block in spans: its share of a matrix fits into the second-level cache at low degree.
constexpr std::int64_t block_edge = 4;

// Greedy: each block takes the first colour that none of its nodes has yet.
SpanBlocks make_blocks(const SolutionSpace& space) {
  const SplineGrid& grid = space.model().grid;
  const Index3 extent = grid.spans();
  std::vector<std::pair<std::int64_t, std::int32_t>> order; // block, span
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const Index3 s = grid.span_index(space.model().cells.span[static_cast<std::size_t>(a)]);
    const auto blocks = [&](std::size_t d) { return (extent[d] + block_edge - 1) / block_edge; };
    order.emplace_back(s[0] / block_edge + blocks(0) * (s[1] / block_edge + blocks(1) * (s[2] / block_edge)),
                       static_cast<std::int32_t>(a));
  }
  std::sort(order.begin(), order.end());

  const auto n = static_cast<std::size_t>(space.num_nodes());
  std::vector<std::vector<bool>> taken; // by colour, then node
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> groups;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && order[last].first == order[first].first) ++last;
    const auto for_nodes = [&](auto visit) {
      for (std::size_t k = first; k < last; ++k)
        for (const std::int32_t i : space.nodes(order[k].second)) visit(static_cast<std::size_t>(i));
    };
    std::size_t colour = 0;
    for (; colour < taken.size(); ++colour) {
      bool is_free = true;
      for_nodes([&](std::size_t i) { is_free = is_free && !taken[colour][i]; });
      if (is_free) break;
    }
    if (colour == taken.size()) {
      taken.emplace_back(n);
      groups.emplace_back();
    }
    for_nodes([&](std::size_t i) { taken[colour][i] = true; });
    groups[colour].emplace_back(first, last);
  }
  SpanBlocks blocks{{0}, {0}, {}};
  for (const auto& group : groups) {
    for (const auto& [first, last] : group) {
      for (std::size_t k = first; k < last; ++k) blocks.spans.push_back(order[k].second);
      blocks.block_offsets.push_back(static_cast<std::int64_t>(blocks.spans.size()));
    }
    blocks.colour_offsets.push_back(static_cast<std::int64_t>(blocks.block_offsets.size()) - 1);
  }
  return blocks;
}

// Visits the lower node pairs of a span in runs: visit(r, c, length, column, place) for the rows nodes[r …  r + length)
// that lie one after the other in column nodes[c] of the pattern, the first one at `place`; `first_node` is added to
// all of them.
// Nodes come in runs of neighbours along u, and so do the pattern's rows.
template <class Visit>
void for_runs(const NodePattern& pattern, std::span<const std::int32_t> nodes, std::int32_t first_node, Visit visit) {
  for (std::size_t c = 0; c < nodes.size(); ++c) {
    const auto column = static_cast<std::size_t>(first_node + nodes[c]);
    const auto* const first = pattern.rows.data() + pattern.offsets[column];
    const auto* const last = pattern.rows.data() + pattern.offsets[column + 1];
    const auto* row = first;
    for (std::size_t r = c; r < nodes.size();) {
      if (*row != first_node + nodes[r]) row = std::lower_bound(row, last, first_node + nodes[r]);
      assert(row != last && *row == first_node + nodes[r]);
      const auto* const begin = row;
      const std::size_t r0 = r;
      do {
        ++row;
        ++r;
      } while (r < nodes.size() && row != last && *row == first_node + nodes[r]);
      visit(static_cast<Eigen::Index>(r0), static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(r - r0), column,
            begin - first);
    }
  }
}

// Products run over a fixed number of column blocks, each with a vector of its own that begins at its first row: the
// sums do not depend on the number of threads.
constexpr std::size_t num_blocks = 16;

// multiply_columns(first, last, part): adds the columns' share of A x to part, whose first entry is unknown 3 first.
template <class MultiplyColumns>
void multiply_in_blocks(const NodePattern& pattern, double* y, MultiplyColumns multiply_columns) {
  const auto n = static_cast<std::size_t>(pattern.num_nodes());
  std::array<std::size_t, num_blocks + 1> first{}, end{};
  for (std::size_t b = 1; b <= num_blocks; ++b) // equal shares of the entries
    first[b] = static_cast<std::size_t>(
        std::lower_bound(pattern.offsets.begin(), pattern.offsets.end() - 1,
                         pattern.num_pairs() * static_cast<std::int64_t>(b) / static_cast<std::int64_t>(num_blocks)) -
        pattern.offsets.begin());
  first[num_blocks] = n;
  std::array<std::vector<double>, num_blocks> parts;
  tbb::parallel_for(std::size_t{0}, num_blocks, [&](std::size_t b) {
    std::size_t last = first[b]; // one beyond the largest row
    for (std::size_t j = first[b]; j < first[b + 1]; ++j)
      last = std::max(last,
                      static_cast<std::size_t>(pattern.rows[static_cast<std::size_t>(pattern.offsets[j + 1] - 1)]) + 1);
    end[b] = last;
    parts[b].assign(3 * (last - first[b]), 0.0);
    multiply_columns(first[b], first[b + 1], parts[b].data());
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const tbb::blocked_range<std::size_t>& range) {
    std::fill(y + 3 * range.begin(), y + 3 * range.end(), 0.0);
    for (std::size_t b = 0; b < num_blocks; ++b) {
      const std::size_t from = std::max(range.begin(), first[b]), to = std::min(range.end(), end[b]);
      for (std::size_t i = 3 * from; i < 3 * to; ++i) y[i] += parts[b][i - 3 * first[b]];
    }
  });
}

} // namespace

namespace {

void append_rows(const RowMatrix& more, RowMatrix& rows) {
  if (rows.rows() == 0) {
    rows = more;
    return;
  }
  RowMatrix both(rows.rows() + more.rows(), more.cols());
  both.topRows(rows.rows()) = rows;
  both.bottomRows(more.rows()) = more;
  rows = std::move(both);
}

// y += Rᵀ diag(w) R x; no weights: all are 1
void add_product(const RowMatrix& rows, const Eigen::VectorXd& weights, const double* x, double* y) {
  if (rows.rows() == 0) return;
  Eigen::VectorXd along = rows * Eigen::Map<const Eigen::VectorXd>(x, rows.cols());
  if (weights.size() > 0) along.array() *= weights.array();
  Eigen::Map<Eigen::VectorXd>(y, rows.cols()) += rows.transpose() * along;
}

} // namespace

Connectivity::Connectivity(const SolutionSpace& space) : Connectivity(std::array{&space}, {}) {}

Connectivity::Connectivity(std::span<const SolutionSpace* const> spaces,
                           std::span<const std::vector<std::int32_t>> coupled) {
  std::vector<NodePattern> parts;
  std::int64_t nodes = 0;
  for (const SolutionSpace* const space : spaces) {
    parts.push_back(make_pattern(*space));
    blocks.push_back(make_blocks(*space));
    first_node.push_back(static_cast<std::int32_t>(nodes));
    nodes += space->num_nodes();
  }
  pattern = with_couples(joined(std::move(parts)), coupled);
}

ZeroedArray::ZeroedArray(std::size_t size) : size_(size) {
  const std::size_t bytes = std::max<std::size_t>(size, 1) * sizeof(double);
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE); // a wish: without it the array is slower, not wrong
  data_ = std::unique_ptr<double, Unmap>(static_cast<double*>(memory), Unmap{bytes});
}

void ZeroedArray::Unmap::operator()(double* p) const {
  munmap(p, bytes);
}

StiffnessMatrix::StiffnessMatrix(std::shared_ptr<const Connectivity> connectivity)
    : connectivity_(std::move(connectivity)), values_(9 * static_cast<std::size_t>(pattern().num_pairs())) {}

void StiffnessMatrix::add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block,
                          std::int32_t first_node) {
  const NodePattern& p = pattern();
  for_runs(p, nodes, first_node,
           [&](Eigen::Index r, Eigen::Index c, Eigen::Index n, std::size_t column, std::ptrdiff_t place) {
             const std::int64_t height = p.offsets[column + 1] - p.offsets[column];
             double* out = values_.data() + 9 * p.offsets[column] + 3 * place;
             for (Eigen::Index b = 0; b < 3; ++b, out += 3 * height) {
               const double* in = &block.coeffRef(3 * r, 3 * c + b);
               for (Eigen::Index k = 0; k < 3 * n; ++k) out[k] += in[k];
             }
           });
}

void StiffnessMatrix::multiply(const double* x, double* y) const {
  const NodePattern& p = pattern();
  multiply_in_blocks(p, y, [&](std::size_t first, std::size_t last, double* part) {
    for (std::size_t j = first; j < last; ++j) {
      const auto begin = static_cast<std::size_t>(p.offsets[j]),
                 height = static_cast<std::size_t>(p.offsets[j + 1]) - begin;
      const double* A = values_.data() + 9 * begin;
      const std::int32_t* rows = p.rows.data() + begin;
      const double xj[3] = {x[3 * j], x[3 * j + 1], x[3 * j + 2]};
      double yj[3] = {0, 0, 0};
      for (std::size_t k = 0; k < height; ++k) {
        const auto i = 3 * static_cast<std::size_t>(rows[k]), at = i - 3 * first;
        const double *A0 = A + 3 * k, *A1 = A0 + 3 * height, *A2 = A1 + 3 * height;
        for (std::size_t a = 0; a < 3; ++a) part[at + a] += A0[a] * xj[0] + A1[a] * xj[1] + A2[a] * xj[2];
        if (k == 0) continue; // the diagonal block is held whole
        for (std::size_t a = 0; a < 3; ++a) {
          yj[0] += A0[a] * x[i + a];
          yj[1] += A1[a] * x[i + a];
          yj[2] += A2[a] * x[i + a];
        }
      }
      for (std::size_t a = 0; a < 3; ++a) part[3 * (j - first) + a] += yj[a];
    }
  });
  add_product(low_rank_, low_rank_weights_, x, y);
}

void StiffnessMatrix::add_low_rank(const RowMatrix& rows, const Eigen::VectorXd& weights) {
  assert(weights.size() == rows.rows());
  if (rows.rows() == 0) return;
  append_rows(rows, low_rank_);
  low_rank_weights_.conservativeResize(low_rank_.rows());
  low_rank_weights_.tail(weights.size()) = weights;
}

Eigen::VectorXd StiffnessMatrix::operator*(const Eigen::VectorXd& x) const {
  assert(x.size() == size());
  Eigen::VectorXd y(size());
  multiply(x.data(), y.data());
  return y;
}

Eigen::VectorXd StiffnessMatrix::diagonal() const {
  const NodePattern& p = pattern();
  Eigen::VectorXd d(size());
  for (std::size_t j = 0; j < static_cast<std::size_t>(p.num_nodes()); ++j) {
    const std::int64_t height = p.offsets[j + 1] - p.offsets[j];
    for (std::int64_t a = 0; a < 3; ++a)
      d[3 * static_cast<Eigen::Index>(j) + a] = values_.data()[9 * p.offsets[j] + 3 * a * height + a];
  }
  return d;
}

MassMatrix::MassMatrix(std::shared_ptr<const Connectivity> connectivity)
    : connectivity_(std::move(connectivity)), values_(static_cast<std::size_t>(pattern().num_pairs())) {}

void MassMatrix::add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block,
                     std::int32_t first_node) {
  const NodePattern& p = pattern();
  for_runs(p, nodes, first_node,
           [&](Eigen::Index r, Eigen::Index c, Eigen::Index n, std::size_t column, std::ptrdiff_t place) {
             double* out = values_.data() + p.offsets[column] + place;
             const double* in = &block.coeffRef(r, c);
             for (Eigen::Index k = 0; k < n; ++k) out[k] += in[k];
           });
}

void MassMatrix::add_low_rank(const RowMatrix& rows) {
  append_rows(rows, low_rank_);
}

void MassMatrix::multiply(const double* x, double* y) const {
  multiply_pattern(x, y);
  add_product(low_rank_, {}, x, y);
}

void MassMatrix::multiply_pattern(const double* x, double* y) const {
  const NodePattern& p = pattern();
  multiply_in_blocks(p, y, [&](std::size_t first, std::size_t last, double* part) {
    for (std::size_t j = first; j < last; ++j) {
      const double xj[3] = {x[3 * j], x[3 * j + 1], x[3 * j + 2]};
      double yj[3] = {0, 0, 0};
      for (auto k = static_cast<std::size_t>(p.offsets[j]); k < static_cast<std::size_t>(p.offsets[j + 1]); ++k) {
        const auto row = static_cast<std::size_t>(p.rows[k]);
        const double m = values_.data()[k];
        for (std::size_t a = 0; a < 3; ++a) part[3 * (row - first) + a] += m * xj[a];
        if (row == j) continue;
        for (std::size_t a = 0; a < 3; ++a) yj[a] += m * x[3 * row + a];
      }
      for (std::size_t a = 0; a < 3; ++a) part[3 * (j - first) + a] += yj[a];
    }
  });
}

Eigen::VectorXd MassMatrix::operator*(const Eigen::VectorXd& x) const {
  assert(x.size() == size());
  Eigen::VectorXd y(size());
  multiply(x.data(), y.data());
  return y;
}

Eigen::VectorXd MassMatrix::diagonal() const {
  Eigen::VectorXd d(pattern().num_nodes());
  for (Eigen::Index j = 0; j < d.size(); ++j) d[j] = values_.data()[pattern().offsets[static_cast<std::size_t>(j)]];
  return d;
}

Eigen::VectorXd MassMatrix::row_sums() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size());
  for (Eigen::Index j = 0; j < pattern().num_nodes(); ++j) x[3 * j] = 1;
  Eigen::VectorXd y(size());
  multiply_pattern(x.data(), y.data());
  Eigen::VectorXd sums(pattern().num_nodes());
  for (Eigen::Index j = 0; j < sums.size(); ++j) sums[j] = y[3 * j];
  return sums;
}

} // namespace iga::solve
