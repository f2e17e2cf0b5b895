// Symmetric matrices over the nodes of a solution space: one pattern shared by stiffness, mass and boundary terms.
#pragma once

#include "solver/solution_space.hpp"

#include <memory>

namespace iga::solve {

/// Lower triangle, node by node: column j holds the rows i >= j whose shape functions share a span with it, ascending;
/// the first one is j itself.
struct NodePattern {
  std::vector<std::int64_t> offsets; ///< (num_nodes + 1)
  std::vector<std::int32_t> rows;    ///< (offsets.back())
  std::int64_t num_nodes() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
  std::int64_t num_pairs() const { return offsets.back(); }
};

/// Spans in groups that share no node, so that the spans of a group may add to a matrix at the same time and every
/// entry has its terms added in the same order whatever the number of threads.
struct SpanColours {
  std::vector<std::int64_t> offsets; ///< (number of colours + 1)
  std::vector<std::int32_t> spans;   ///< active spans, colour by colour
};

/// Sparsity and colouring of a space; made once, shared by all matrices.
struct Connectivity {
  explicit Connectivity(const SolutionSpace& space);
  NodePattern pattern;
  SpanColours colours;
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
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }

  /// Adds a span's symmetric matrix; unknown 3 r + a belongs to nodes[r]. Only the lower triangle of `block` is read.
  /// Spans of one colour may be added at the same time.
  void add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block);
  /// y = A x; parallel, the same bits for any number of threads.
  void multiply(const double* x, double* y) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  Eigen::VectorXd diagonal() const;

 private:
  std::shared_ptr<const Connectivity> connectivity_;
  std::vector<double> values_;
};

/// Symmetric (n × n) matrix over the nodes that acts on each of the three components alike: a mass matrix.
class MassMatrix {
 public:
  MassMatrix() = default;
  explicit MassMatrix(std::shared_ptr<const Connectivity> connectivity);

  const NodePattern& pattern() const { return connectivity_->pattern; }
  std::int64_t size() const { return 3 * pattern().num_nodes(); }
  std::span<double> values() { return values_; } ///< in the order of the pattern's rows
  std::span<const double> values() const { return values_; }

  void add(std::span<const std::int32_t> nodes, const Eigen::Ref<const Eigen::MatrixXd>& block);
  void multiply(const double* x, double* y) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  Eigen::VectorXd diagonal() const; ///< (num_nodes)
  Eigen::VectorXd row_sums() const; ///< (num_nodes): the lumped mass

 private:
  std::shared_ptr<const Connectivity> connectivity_;
  std::vector<double> values_;
};

} // namespace iga::solve
