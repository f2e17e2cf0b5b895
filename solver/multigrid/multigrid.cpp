#include "solver/multigrid/multigrid.hpp"

#include "format/model/errors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

using Eigen::MatrixXd;

// Vectors side by side in the unknowns: one, or as many as registers take.
using Wide4 [[gnu::vector_size(4 * sizeof(float))]] = float;
using Wide8 [[gnu::vector_size(8 * sizeof(float))]] = float;
using Wide16 [[gnu::vector_size(16 * sizeof(float))]] = float;
template <class Wide> constexpr int width_of = static_cast<int>(sizeof(Wide) / sizeof(float));
template <class Wide> float& lane(Wide& x, int k) {
  return reinterpret_cast<float*>(&x)[k];
}

// Added to the unit diagonal of a block's matrix, the least that makes it positive definite: single precision knows it
// no better.
constexpr double block_additions[]{1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
// A node whose stiffness is this share of its stiffest neighbour's is weak; what is added to its unit diagonal, and to
// that of nodes of held cells and at gap ends.
constexpr double weak_share = 0.1, weak_addition = 1e-5, held_addition = 1e-5;
// Added to the unit diagonal of the coarsest matrix where coarse functions are dependent on what is left of them.
constexpr double additions[]{0, 1e-13, 1e-11, 1e-9};

std::size_t at(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

struct FloatTransfer { // weights between scaled unknowns
  std::vector<std::int64_t> offsets;
  std::vector<std::int32_t> nodes;
  std::vector<float> weights;
};

FloatTransfer scaled(const Transfer& transfer, const std::vector<double>& row, const std::vector<double>& column,
                     bool divide_row) {
  FloatTransfer result{transfer.offsets, transfer.nodes, std::vector<float>(transfer.weights.size())};
  for (std::int64_t i = 0; i < transfer.num_fine(); ++i)
    for (auto t = transfer.offsets[at(i)]; t < transfer.offsets[at(i) + 1]; ++t) {
      const double c = column[at(transfer.nodes[at(t)])], r = row[at(i)];
      result.weights[at(t)] = static_cast<float>(transfer.weights[at(t)] * (divide_row ? c / r : r / c));
    }
  return result;
}

struct Level {
  BlockRows<float, 9> A; // S A S with S = scale
  NodeBlocks blocks;
  Groups groups; // of blocks
  std::vector<std::int64_t> inverse_offsets;
  std::vector<float> inverses;             // of the blocks' own matrices, whole
  FloatTransfer prolongation, restriction; // between this level and the next
};

template <class Wide> struct Vectors {
  std::vector<Wide> x, b, r; // three entries a node
};

// b_i - (A x)_i
template <class Wide>
void defect(const Level& level, std::int64_t i, const Wide* x, const Wide* b, Wide& r0, Wide& r1, Wide& r2) {
  const RowPattern& p = *level.A.pattern;
  r0 = b[3 * i];
  r1 = b[3 * i + 1];
  r2 = b[3 * i + 2];
  const float* A = level.A.row(i);
  for (auto k = p.offsets[at(i)]; k < p.offsets[at(i) + 1]; ++k, A += 9) {
    const Wide* xj = x + 3 * std::int64_t{p.columns[at(k)]};
    const Wide x0 = xj[0], x1 = xj[1], x2 = xj[2];
    r0 -= A[0] * x0;
    r0 -= A[1] * x1;
    r0 -= A[2] * x2;
    r1 -= A[3] * x0;
    r1 -= A[4] * x1;
    r1 -= A[5] * x2;
    r2 -= A[6] * x0;
    r2 -= A[7] * x1;
    r2 -= A[8] * x2;
  }
}

// x += A_bb⁻¹ (b - A x)_b on the nodes of a block.
template <class Wide> void relax(const Level& level, std::int64_t block, Wide* x, const Wide* b, Wide* r, Wide* d) {
  const auto first = level.blocks.offsets[at(block)], count = level.blocks.offsets[at(block) + 1] - first;
  const std::int32_t* nodes = level.blocks.nodes.data() + first;
  for (std::int64_t k = 0; k < count; ++k)
    defect(level, std::int64_t{nodes[k]}, x, b, r[3 * k], r[3 * k + 1], r[3 * k + 2]);
  const std::int64_t n = 3 * count;
  const float* inverse = level.inverses.data() + level.inverse_offsets[at(block)];
  for (std::int64_t i = 0; i < n; ++i) d[i] = Wide{};
  if constexpr (width_of<Wide> == 1) {
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) d[i] += inverse[j * n + i] * r[j];
  } else {
    for (std::int64_t i = 0; i < n; i += 3) { // three rows share what they read
      const float *a0 = inverse + i * n, *a1 = a0 + n, *a2 = a1 + n;
      Wide d0{}, d1{}, d2{};
      for (std::int64_t j = 0; j < n; ++j) {
        d0 += a0[j] * r[j];
        d1 += a1[j] * r[j];
        d2 += a2[j] * r[j];
      }
      d[i] = d0;
      d[i + 1] = d1;
      d[i + 2] = d2;
    }
  }
  for (std::int64_t k = 0; k < count; ++k)
    for (std::int64_t a = 0; a < 3; ++a) x[3 * std::int64_t{nodes[k]} + a] += d[3 * k + a];
}

template <class Wide> void sweep(const Level& level, bool forward, Wide* x, const Wide* b) {
  const auto count = static_cast<std::int64_t>(level.groups.offsets.size()) - 1;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t g = forward ? k : count - 1 - k;
    tbb::parallel_for(level.groups.offsets[at(g)], level.groups.offsets[at(g) + 1], [&](std::int64_t c) {
      std::array<Wide, 3 * most_in_block> r, d;
      const auto [first, last] = level.groups.chunks[at(c)];
      if (forward)
        for (std::int64_t i = first; i < last; ++i) relax(level, i, x, b, r.data(), d.data());
      else
        for (std::int64_t i = std::int64_t{last} - 1; i >= first; --i) relax(level, i, x, b, r.data(), d.data());
    });
  }
}

template <class Visit> void for_rows(std::int64_t n, Visit visit) {
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, n, 256), [&](const tbb::blocked_range<std::int64_t>& range) {
    for (std::int64_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
}

// y_i (=, +=) Σ w x_j
template <class Wide> void carry(const FloatTransfer& transfer, bool add, const Wide* x, Wide* y) {
  for_rows(static_cast<std::int64_t>(transfer.offsets.size()) - 1, [&](std::int64_t i) {
    Wide s0{}, s1{}, s2{};
    for (auto t = transfer.offsets[at(i)]; t < transfer.offsets[at(i) + 1]; ++t) {
      const Wide* xj = x + 3 * std::int64_t{transfer.nodes[at(t)]};
      const float w = transfer.weights[at(t)];
      s0 += w * xj[0];
      s1 += w * xj[1];
      s2 += w * xj[2];
    }
    Wide* yi = y + 3 * i;
    yi[0] = add ? yi[0] + s0 : s0;
    yi[1] = add ? yi[1] + s1 : s1;
    yi[2] = add ? yi[2] + s2 : s2;
  });
}

} // namespace

struct Multigrid::Hierarchy {
  MultigridSettings settings;
  std::vector<std::int64_t> nodes; // by level
  std::vector<double> scale;       // of the finest level
  std::vector<Level> levels;       // all but the coarsest
  Eigen::LLT<MatrixXd> coarsest;
  mutable std::tuple<std::vector<Vectors<float>>, std::vector<Vectors<Wide4>>, std::vector<Vectors<Wide8>>,
                     std::vector<Vectors<Wide16>>>
      work;

  Hierarchy(const ShiftedStiffness& A, const BodySystem& system, const MultigridSettings& all,
            std::span<const std::vector<std::int64_t>> held);
  void add_level(BlockRows<float, 9> A, NodeBlocks blocks, const std::vector<double>& node_scales,
                 FloatTransfer prolongation, FloatTransfer restriction);
  void factorise(const MatrixXd& A);
  template <class Wide> std::vector<Vectors<Wide>>& vectors() const;
  template <class Wide> void cycle(std::vector<Vectors<Wide>>& v, std::size_t l) const;
  template <class Wide> void solve_coarsest(Vectors<Wide>& v) const;
  template <class Wide> void apply(const double* r, double* z, int columns) const;
};

namespace {

// Scaled, whole.
MatrixXd full(const BlockRows<double, 9>& A, const std::vector<double>& scale) {
  const RowPattern& p = *A.pattern;
  MatrixXd result = MatrixXd::Zero(3 * p.size(), 3 * p.size());
  for (std::int64_t i = 0; i < p.size(); ++i)
    for (auto k = p.offsets[at(i)]; k < p.offsets[at(i) + 1]; ++k) {
      const std::int64_t j = p.columns[at(k)];
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          result(3 * i + a, 3 * j + b) = scale[at(i)] * scale[at(j)] * A.values.data()[9 * k + 3 * a + b];
    }
  return result;
}

MatrixXd full(const ShiftedStiffness& A, const std::vector<double>& scale) {
  const std::int64_t n = A.stiffness->pattern().num_nodes();
  MatrixXd result = MatrixXd::Zero(3 * n, 3 * n);
  for (std::int64_t j = 0; j < n; ++j)
    A.upper(j, [&](std::int32_t i, const double* block) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          result(3 * i + b, 3 * j + a) = result(3 * j + a, 3 * i + b) = scale[at(i)] * scale[at(j)] * block[3 * a + b];
    });
  return result;
}

MatrixXd block_matrix(const Level& level, std::int64_t block) {
  const auto first = level.blocks.offsets[at(block)], count = level.blocks.offsets[at(block) + 1] - first;
  const std::int32_t* nodes = level.blocks.nodes.data() + first; // ascending
  const RowPattern& p = *level.A.pattern;
  MatrixXd A = MatrixXd::Zero(3 * count, 3 * count);
  for (std::int64_t i = 0; i < count; ++i) {
    std::int64_t j = 0;
    for (auto k = p.offsets[at(nodes[i])]; k < p.offsets[at(nodes[i]) + 1] && j < count; ++k) {
      while (j < count && nodes[j] < p.columns[at(k)]) ++j;
      if (j == count || nodes[j] != p.columns[at(k)]) continue;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) A(3 * i + a, 3 * j + b) = double{level.A.values.data()[9 * k + 3 * a + b]};
    }
  }
  return A;
}

// Functions that hold little material are nearly dependent, and single precision would make their matrix indefinite.
// What is added to their own diagonal is far below what they feel as parts of any motion of the whole.
void support_weak_nodes(BlockRows<float, 9>& A, const NodeBlocks& blocks, const std::vector<double>& scale) {
  const RowPattern& p = *A.pattern;
  std::vector<std::uint8_t> seen(at(p.size()), 0); // held: in more than one block
  for (const std::int32_t node : blocks.nodes)
    seen[at(node)] = static_cast<std::uint8_t>(std::min(2, seen[at(node)] + 1));
  for_rows(p.size(), [&](std::int64_t i) {
    double stiffest = scale[at(i)];
    std::int64_t diagonal = 0;
    for (auto k = p.offsets[at(i)]; k < p.offsets[at(i) + 1]; ++k) {
      stiffest = std::min(stiffest, scale[at(p.columns[at(k)])]);
      if (p.columns[at(k)] == i) diagonal = k;
    }
    const double added = seen[at(i)] > 1                                     ? held_addition
                         : std::pow(stiffest / scale[at(i)], 2) < weak_share ? weak_addition
                                                                             : 0;
    for (int a = 0; a < 3; ++a) A.values.data()[9 * diagonal + 4 * a] += static_cast<float>(added);
  });
}

MatrixXd inverse_of(const MatrixXd& A) {
  for (const double added : block_additions) {
    MatrixXd B = A;
    B.diagonal().array() += added;
    const Eigen::LLT<MatrixXd> factor(B);
    if (factor.info() == Eigen::Success) return factor.solve(MatrixXd::Identity(A.rows(), A.rows()));
  }
  throw NumericalError("a block of the multigrid solver is not positive definite: the part is not held, or rounding is "
                       "too large; use solver = \"direct\"");
}

} // namespace

Multigrid::Hierarchy::Hierarchy(const ShiftedStiffness& A, const BodySystem& system, const MultigridSettings& all,
                                std::span<const std::vector<std::int64_t>> held)
    : settings(all) {
  SplineHierarchy spaces = spline_hierarchy(system, settings.few_nodes, held);
  const std::vector<Transfer>& transfers = spaces.transfers;
  nodes.push_back(system.num_nodes());
  for (const Transfer& transfer : transfers) nodes.push_back(transfer.num_coarse);
  if (nodes.back() > settings.most_nodes)
    throw InputError(
        fmt::format("the multigrid solver finds no coarse grid for this model: {} nodes are left of {}, at "
                    "most {} are wanted (many parts that move on their own?); use solver = \"direct\"",
                    nodes.back(), nodes.front(), settings.most_nodes));
  scale = node_scale(A);
  if (transfers.empty()) {
    factorise(full(A, scale));
    return;
  }
  std::vector<double> fine_scale = scale;
  BlockRows<double, 9> coarse;
  for (std::size_t l = 0; l < transfers.size(); ++l) {
    const Transfer& P = transfers[l];
    const Transfer transpose = transposed(P);
    const std::shared_ptr<const RowPattern> fine = l == 0 ? row_pattern(A.stiffness->pattern()) : coarse.pattern;
    const auto pattern = coarse_pattern(*fine, P, transpose);
    BlockRows<double, 9> next =
        l == 0 ? coarse_stiffness(A, P, transpose, pattern) : coarse_stiffness(coarse, P, transpose, pattern);
    std::vector<double> next_scale = node_scale(next);
    add_level(l == 0 ? scaled_rows(A, fine, fine_scale) : scaled_rows(coarse, fine_scale), std::move(spaces.blocks[l]),
              fine_scale, scaled(P, fine_scale, next_scale, true), scaled(transpose, next_scale, fine_scale, false));
    coarse = std::move(next);
    fine_scale = std::move(next_scale);
  }
  factorise(full(coarse, fine_scale));
}

void Multigrid::Hierarchy::add_level(BlockRows<float, 9> A, NodeBlocks blocks, const std::vector<double>& node_scales,
                                     FloatTransfer prolongation, FloatTransfer restriction) {
  support_weak_nodes(A, blocks, node_scales);
  Level level{std::move(A), std::move(blocks), {}, {0}, {}, std::move(prolongation), std::move(restriction)};
  level.groups = independent_blocks(level.blocks, *level.A.pattern);
  for (std::int64_t b = 0; b < level.blocks.size(); ++b) {
    const auto n = 3 * (level.blocks.offsets[at(b) + 1] - level.blocks.offsets[at(b)]);
    level.inverse_offsets.push_back(level.inverse_offsets.back() + n * n);
  }
  level.inverses.resize(at(level.inverse_offsets.back()));
  tbb::parallel_for(std::int64_t{0}, level.blocks.size(), [&](std::int64_t b) {
    const MatrixXd inverse = inverse_of(block_matrix(level, b));
    std::copy_n(inverse.cast<float>().eval().data(), inverse.size(),
                level.inverses.begin() + level.inverse_offsets[at(b)]);
  });
  levels.push_back(std::move(level));
}

void Multigrid::Hierarchy::factorise(const MatrixXd& A) {
  for (const double added : additions) {
    MatrixXd B = A;
    B.diagonal().array() += added;
    coarsest.compute(B);
    if (coarsest.info() == Eigen::Success) return;
  }
  throw NumericalError("the coarsest matrix of the multigrid solver is not positive definite: the part is not held, or "
                       "rounding is too large; use solver = \"direct\"");
}

template <class Wide> std::vector<Vectors<Wide>>& Multigrid::Hierarchy::vectors() const {
  auto& v = std::get<std::vector<Vectors<Wide>>>(work);
  v.resize(nodes.size());
  for (std::size_t l = 0; l < nodes.size(); ++l) {
    const auto size = at(3 * nodes[l]);
    v[l].x.resize(size);
    v[l].b.resize(size);
    if (l + 1 < nodes.size()) v[l].r.resize(size);
  }
  return v;
}

template <class Wide> void Multigrid::Hierarchy::solve_coarsest(Vectors<Wide>& v) const {
  constexpr int width = width_of<Wide>;
  MatrixXd b(3 * nodes.back(), width);
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    for (int k = 0; k < width; ++k) b(i, k) = double{lane(v.b[at(i)], k)};
  coarsest.solveInPlace(b);
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    for (int k = 0; k < width; ++k) lane(v.x[at(i)], k) = static_cast<float>(b(i, k));
}

template <class Wide> void Multigrid::Hierarchy::cycle(std::vector<Vectors<Wide>>& v, std::size_t l) const {
  if (l == levels.size()) return solve_coarsest(v[l]);
  const Level& level = levels[l];
  Wide *const x = v[l].x.data(), *const b = v[l].b.data(), *const r = v[l].r.data();
  std::fill(v[l].x.begin(), v[l].x.end(), Wide{});
  for (int s = 0; s < settings.sweeps; ++s) sweep(level, true, x, b);
  for_rows(nodes[l], [&](std::int64_t i) { defect(level, i, x, b, r[3 * i], r[3 * i + 1], r[3 * i + 2]); });
  carry(level.restriction, false, r, v[l + 1].b.data());
  cycle(v, l + 1);
  carry(level.prolongation, true, v[l + 1].x.data(), x);
  for (int s = 0; s < settings.sweeps; ++s) sweep(level, false, x, b);
}

// Each column is brought to the size of one: single precision has but 38 orders.
template <class Wide> void Multigrid::Hierarchy::apply(const double* r, double* z, int columns) const {
  auto& v = vectors<Wide>();
  const std::int64_t n = 3 * nodes.front();
  std::array<double, static_cast<std::size_t>(width_of<Wide>)> largest{};
  for (int k = 0; k < columns; ++k)
    for (std::int64_t i = 0; i < n; ++i)
      largest[at(k)] = std::max(largest[at(k)], std::abs(scale[at(i / 3)] * r[k * n + i]));
  for_rows(nodes.front(), [&](std::int64_t i) {
    for (std::int64_t u = 3 * i; u < 3 * i + 3; ++u) {
      v[0].b[at(u)] = Wide{};
      for (int k = 0; k < columns; ++k)
        if (largest[at(k)] > 0)
          lane(v[0].b[at(u)], k) = static_cast<float>(scale[at(i)] * r[k * n + u] / largest[at(k)]);
    }
  });
  cycle(v, 0);
  for_rows(nodes.front(), [&](std::int64_t i) {
    for (std::int64_t u = 3 * i; u < 3 * i + 3; ++u)
      for (int k = 0; k < columns; ++k) z[k * n + u] = scale[at(i)] * largest[at(k)] * double{lane(v[0].x[at(u)], k)};
  });
}

Multigrid::Multigrid(const ShiftedStiffness& A, const BodySystem& system, const MultigridSettings& settings,
                     std::span<const std::vector<std::int64_t>> held)
    : hierarchy_(std::make_unique<Hierarchy>(A, system, settings, held)) {}
Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;
Multigrid& Multigrid::operator=(Multigrid&&) noexcept = default;

void Multigrid::apply(const double* r, double* z, int columns) const {
  const std::int64_t n = size();
  for (int first = 0; first < columns;) {
    const int left = columns - first;
    const int count = std::min(left, 16);
    const double* from = r + first * n;
    double* to = z + first * n;
    if (count > 8)
      hierarchy_->apply<Wide16>(from, to, count);
    else if (count > 4)
      hierarchy_->apply<Wide8>(from, to, count);
    else if (count > 1)
      hierarchy_->apply<Wide4>(from, to, count);
    else
      hierarchy_->apply<float>(from, to, count);
    first += count;
  }
}

std::int64_t Multigrid::size() const {
  return 3 * hierarchy_->nodes.front();
}

std::vector<std::int64_t> Multigrid::level_nodes() const {
  return hierarchy_->nodes;
}

double Multigrid::bytes() const {
  double sum = 8.0 * static_cast<double>(hierarchy_->coarsest.rows() * hierarchy_->coarsest.rows());
  for (const Level& level : hierarchy_->levels)
    sum += static_cast<double>(4 * level.A.values.size() + 4 * level.A.pattern->columns.size() +
                               8 * (level.prolongation.nodes.size() + level.restriction.nodes.size()) +
                               4 * level.inverses.size());
  return sum;
}

} // namespace iga::solve
