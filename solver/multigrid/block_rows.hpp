// Sparse symmetric matrices stored by whole rows, their products with coarser spaces, and rows in independent groups.
#pragma once

#include "solver/mechanics/mass_operator.hpp"
#include "solver/multigrid/spline_levels.hpp"

#include <memory>

namespace iga::solve {

/// Values that nobody sets to zero first: the thread that writes them takes the memory.
template <class Value> class RawArray {
 public:
  RawArray() = default;
  explicit RawArray(std::size_t size) : data_(new Value[size]), size_(size) {}
  Value* data() { return data_.get(); }
  const Value* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  std::unique_ptr<Value[]> data_;
  std::size_t size_ = 0;
};

/// Columns of each row, ascending; the pattern is symmetric.
struct RowPattern {
  std::vector<std::int64_t> offsets; ///< (n + 1)
  std::vector<std::int32_t> columns; ///< (offsets.back())
  std::int64_t size() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
  std::int64_t num_entries() const { return offsets.back(); }
};

/// Entries are blocks of `Entry` numbers: 9 (3 × 3, row by row) of a stiffness, 1 of a mass.
template <class Real, int Entry> struct BlockRows {
  std::shared_ptr<const RowPattern> pattern;
  RawArray<Real> values; ///< Entry numbers for each of the pattern's columns
  const Real* row(std::int64_t i) const {
    return values.data() + Entry * pattern->offsets[static_cast<std::size_t>(i)];
  }
};

/// Whole rows from the lower triangle.
std::shared_ptr<const RowPattern> row_pattern(const NodePattern& lower);

/// A = K - shift M as multigrid sees it; the parts of low rank are left out. Pointers must outlive it.
struct ShiftedStiffness {
  const StiffnessMatrix* stiffness = nullptr;
  const MassOperator* mass = nullptr; ///< null: none. Of a multi-pass mass the lumped one is taken
  double shift = 0;

  /// visit(i, A_ji) for i >= j: blocks right of the diagonal of row j and that on it, row by row.
  template <class Visit> void upper(std::int64_t j, Visit visit) const {
    const NodePattern& p = stiffness->pattern();
    const auto begin = p.offsets[static_cast<std::size_t>(j)],
               height = p.offsets[static_cast<std::size_t>(j) + 1] - begin;
    const double* K = stiffness->values().data() + 9 * begin;
    const double* M = mass && mass->is_consistent() ? mass->matrix()->values().data() + begin : nullptr;
    double block[9];
    for (std::int64_t k = 0; k < height; ++k) {
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a) block[3 * b + a] = K[3 * k + a + 3 * height * b];
      double m = M ? M[k] : 0;
      if (!M && mass && k == 0) m = (*mass->masses())[j];
      for (int a = 0; a < 3; ++a) block[4 * a] -= shift * m;
      visit(p.rows[static_cast<std::size_t>(begin + k)], block);
    }
  }
};

/// The mass alone, an entry per pair of nodes; of a multi-pass mass the lumped one.
struct MassRows {
  const MassOperator* mass = nullptr;
  const NodePattern* pattern = nullptr;
  template <class Visit> void upper(std::int64_t j, Visit visit) const {
    if (!mass->is_consistent()) {
      const double m = (*mass->masses())[j];
      visit(static_cast<std::int32_t>(j), &m);
      return;
    }
    for (auto k = pattern->offsets[static_cast<std::size_t>(j)]; k < pattern->offsets[static_cast<std::size_t>(j) + 1];
         ++k)
      visit(pattern->rows[static_cast<std::size_t>(k)], mass->matrix()->values().data() + k);
  }
};

/// Whole rows of single precision, row i and column j times scale[i] scale[j].
BlockRows<float, 9> scaled_rows(const ShiftedStiffness& A, std::shared_ptr<const RowPattern> pattern,
                                const std::vector<double>& scale);
BlockRows<float, 9> scaled_rows(const BlockRows<double, 9>& A, const std::vector<double>& scale);

/// (n): one over the root of the mean of each diagonal block's diagonal; 1 where that is not positive.
std::vector<double> node_scale(const ShiftedStiffness& A);
std::vector<double> node_scale(const BlockRows<double, 9>& A);

/// The coarse terms' rows: fine nodes of each coarse one.
Transfer transposed(const Transfer& transfer);

/// Items in chunks of neighbours, chunks in groups of which no two have to do with each other: those of a group may be
/// worked on at the same time, and the result is that of one order of all items, whatever the number of threads.
struct Groups {
  std::vector<std::int64_t> offsets;                         ///< (groups + 1): into chunks
  std::vector<std::pair<std::int32_t, std::int32_t>> chunks; ///< first item, last + 1
};
/// Blocks; no two of a group's different chunks have neighbouring nodes.
Groups independent_blocks(const NodeBlocks& blocks, const RowPattern& pattern);
/// Fine rows; no two of a group's different chunks share a coarse node.
Groups independent_rows(const Transfer& transfer, const Transfer& transpose);

/// Pattern of Pᵀ A P.
std::shared_ptr<const RowPattern> coarse_pattern(const RowPattern& fine, const Transfer& P, const Transfer& transpose);
/// Pᵀ A P. (Galerkin)
BlockRows<double, 9> coarse_stiffness(const ShiftedStiffness& A, const Transfer& P, const Transfer& transpose,
                                      std::shared_ptr<const RowPattern> pattern);
BlockRows<double, 9> coarse_stiffness(const BlockRows<double, 9>& A, const Transfer& P, const Transfer& transpose,
                                      std::shared_ptr<const RowPattern> pattern);
BlockRows<double, 1> coarse_mass(const MassRows& M, const Transfer& P, const Transfer& transpose,
                                 std::shared_ptr<const RowPattern> pattern);
BlockRows<double, 1> coarse_mass(const BlockRows<double, 1>& M, const Transfer& P, const Transfer& transpose,
                                 std::shared_ptr<const RowPattern> pattern);

} // namespace iga::solve
