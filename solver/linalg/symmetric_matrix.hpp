// Symmetric matrices over the nodes of a solution space: one pattern shared by stiffness, mass and boundary terms.
#pragma once

#include "solver/space/solution_space.hpp"

#include <Eigen/SparseCore>
#include <memory>
#include <tbb/parallel_for.h>

namespace iga::solve {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>; ///< few rows over all unknowns

/// Lower triangle, node by node: column j holds the rows i >= j whose shape functions share a span with it, ascending;
/// the first one is j itself.
struct NodePattern {
  std::vector<std::int64_t> offsets; ///< (num_nodes + 1)
  std::vector<std::int32_t> rows;    ///< (offsets.back())
  std::int64_t num_nodes() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
  std::int64_t num_pairs() const { return offsets.back(); }
};

/// Active spans in blocks of neighbours, blocks in groups that share no node: the blocks of a group may add to a matrix
/// at the same time, and every entry has its terms added in the same order whatever the number of threads. A block's
/// part of a matrix stays in the cache while its spans are added.
struct SpanBlocks {
  std::vector<std::int64_t> colour_offsets; ///< (number of colours + 1): into block_offsets
  std::vector<std::int64_t> block_offsets;  ///< (number of blocks + 1): into spans
  std::vector<std::int32_t> spans;          ///< (num_spans)
};

/// Sparsity and order of assembly of one space, or of several whose nodes follow one another; made once, shared by all
/// matrices.
struct Connectivity {
  explicit Connectivity(const SolutionSpace& space);
  /// @param coupled  sets of nodes, numbered over all spaces, that share entries although they share no span
  Connectivity(std::span<const SolutionSpace* const> spaces, std::span<const std::vector<std::int32_t>> coupled);
  NodePattern pattern;
  std::vector<SpanBlocks> blocks;       ///< by space
  std::vector<std::int32_t> first_node; ///< by space
};

/// Runs visit(a) for every active span of a space; parallel over the blocks of a colour, so that visit may add to
/// matrices and vectors of this connectivity.
template <class Visit> void for_spans(const SpanBlocks& blocks, Visit visit) {
  for (std::size_t c = 0; c + 1 < blocks.colour_offsets.size(); ++c)
    tbb::parallel_for(blocks.colour_offsets[c], blocks.colour_offsets[c + 1], [&](std::int64_t b) {
      const auto block = static_cast<std::size_t>(b);
      for (auto k = blocks.block_offsets[block]; k < blocks.block_offsets[block + 1]; ++k)
        visit(static_cast<std::int64_t>(blocks.spans[static_cast<std::size_t>(k)]));
    });
}

/// Zeros that take memory when they are first written, by the thread that writes them, in large pages where the system
/// has them: with small ones threads queue for the page table.
class ZeroedArray {
 public:
  ZeroedArray() = default;
  explicit ZeroedArray(std::size_t size);
  double* data() { return data_.get(); }
  const double* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(double* p) const;
  };
  std::unique_ptr<double, Unmap> data_{nullptr, Unmap{0}};
  std::size_t size_ = 0;
};

/// Symmetric (3 n × 3 n) matrix of 3 × 3 blocks over a node pattern. The values are those of a compressed-column
/// matrix: column 3 j + b starts at 9 offsets[j] + 3 b (offsets[j+1] - offsets[j]) and holds rows 3 i + a for the i of
/// column j, a fastest. The diagonal blocks are held whole (their upper triangles too).
class StiffnessMatrix {
 public:
  StiffnessMatrix() = default;
  explicit StiffnessMatrix(std::shared_ptr<const Connectivity> connectivity);

  const Connectivity& connectivity() const { return *connectivity_; }
  const std::shared_ptr<const Connectivity>& shared_connectivity() const { return connectivity_; }
  const NodePattern& pattern() const { return connectivity_->pattern; }
  std::int64_t size() const { return 3 * pattern().num_nodes(); }
  std::span<double> values() { return {values_.data(), values_.size()}; }
  std::span<const double> values() const { return {values_.data(), values_.size()}; }

  /// Adds a span's symmetric matrix; unknown 3 r + a belongs to nodes[r]. Of `block` only the 3 × 3 blocks on and below
  /// the diagonal are read, those on it whole. Within for_spans.
  /// @param nodes  ascending, counted from first_node
  void add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block,
           std::int32_t first_node = 0);
  /// Adds Rᵀ diag(w) R, which does not fit the pattern: values() and diagonal() leave it out, products and
  /// factorisations take it. @param rows  (rank × size) @param weights  (rank), not 0, of either sign
  void add_low_rank(const RowMatrix& rows, const Eigen::VectorXd& weights);
  void add_low_rank(const RowMatrix& rows) { add_low_rank(rows, Eigen::VectorXd::Ones(rows.rows())); }
  const RowMatrix& low_rank() const { return low_rank_; } ///< all rows added so; none: no rows, no columns
  const Eigen::VectorXd& low_rank_weights() const { return low_rank_weights_; } ///< (rank)
  /// y = A x; parallel, the same bits for any number of threads.
  void multiply(const double* x, double* y) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  Eigen::VectorXd diagonal() const;

 private:
  std::shared_ptr<const Connectivity> connectivity_;
  ZeroedArray values_;
  RowMatrix low_rank_;
  Eigen::VectorXd low_rank_weights_;
};

/// Symmetric (n × n) matrix over the nodes that acts on each of the three components alike: a mass matrix; with a part
/// of low rank that does not (StiffnessMatrix::add_low_rank), a rigid body's.
class MassMatrix {
 public:
  MassMatrix() = default;
  explicit MassMatrix(std::shared_ptr<const Connectivity> connectivity);

  const NodePattern& pattern() const { return connectivity_->pattern; }
  std::int64_t size() const { return 3 * pattern().num_nodes(); }
  std::span<double> values() { return {values_.data(), values_.size()}; } ///< in the order of the pattern's rows
  std::span<const double> values() const { return {values_.data(), values_.size()}; }

  void add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block,
           std::int32_t first_node = 0);
  void add_low_rank(const RowMatrix& rows);
  const RowMatrix& low_rank() const { return low_rank_; }
  void multiply(const double* x, double* y) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  Eigen::VectorXd diagonal() const; ///< (num_nodes)
  Eigen::VectorXd row_sums() const; ///< (num_nodes): the lumped mass, without the part of low rank

 private:
  void multiply_pattern(const double* x, double* y) const;

  std::shared_ptr<const Connectivity> connectivity_;
  ZeroedArray values_;
  RowMatrix low_rank_;
};

} // namespace iga::solve
