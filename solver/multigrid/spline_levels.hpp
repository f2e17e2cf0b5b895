// Coarser spline spaces of the same body, and how their functions are made of finer ones: pairs of spans become one,
// and every coarse B-spline is a sum of fine ones (knot insertion), also where functions have copies.
#pragma once

#include "solver/mechanics/body_system.hpp"

namespace iga::solve {

/// Coefficients of fine nodes from those of coarse ones, the same for all three components: sparse rows.
struct Transfer {
  std::vector<std::int64_t> offsets; ///< (fine nodes + 1)
  std::vector<std::int32_t> nodes;   ///< coarse node of each term, ascending within a row
  std::vector<double> weights;
  std::int64_t num_coarse = 0;
  std::int64_t num_fine() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
};

/// A spline space as its unknowns and the cells that see them. An *unknown* is a copy of a B-spline, on the finest
/// level also a Bernstein coefficient beside the end of a gap; a *node* is one that carries equations.
class SplineLevel {
 public:
  /// The level of a solution space: its nodes, and the model's unknowns, of which light ones are no nodes.
  /// @param held  cells under supports and ties
  explicit SplineLevel(const SolutionSpace& space, std::span<const std::int64_t> held = {});

  /// The space on every other knot. A coarse B-spline has a copy for each connected part of the fine unknowns that it
  /// is made of (two that share a cell are connected): walls that move apart do so on every level on which their
  /// distance is wider than the support of a function. Rows of nodes alone: coefficients of light functions follow from
  /// these, and their extrapolation keeps polynomials up to its degree. A coarse copy without nodes below it is none
  /// itself.
  /// @param[out] transfer  nodes of this level from those of the coarse one
  SplineLevel coarsen(Transfer& transfer) const;

  std::int64_t num_nodes() const { return num_nodes_; }
  std::int64_t num_unknowns() const { return static_cast<std::int64_t>(coefficient_.size()); }
  const KnotVector& knots(int d) const { return knots_[static_cast<std::size_t>(d)]; }
  /// Node of an unknown, -1 for none.
  std::int32_t node_of(std::int64_t unknown) const { return node_of_[static_cast<std::size_t>(unknown)]; }
  /// The B-spline, by direction, that an unknown of a coarse level is a copy of.
  const std::array<std::int32_t, 3>& function_of(std::int64_t unknown) const {
    return coefficient_[static_cast<std::size_t>(unknown)];
  }
  /// Where each node lies among the functions, by direction: a B-spline's number, of a Bernstein coefficient that of a
  /// B-spline near it. (num_nodes)
  std::vector<std::array<std::int32_t, 3>> node_places() const;
  /// Nodes of each cell that holds one of the held cells.
  std::vector<std::vector<std::int32_t>> held_nodes() const;

 private:
  SplineLevel() = default;

  /// Terms of one coefficient, in one direction: consecutive coarse B-splines from `first` on.
  struct Row {
    std::int32_t first = 0, count = 0;
    std::array<double, max_degree + 1> weights{};
  };
  std::vector<Row> rows(std::size_t d, const KnotVector& coarse) const;
  std::int32_t num_functions(std::size_t d) const { return static_cast<std::int32_t>(knots_[d].num_functions()); }

  std::array<KnotVector, 3> knots_;
  /// (unknowns): in each direction a B-spline's number or, from num_functions(d) on, (p + 1) span + k for the k-th
  /// Bernstein coefficient of a span.
  std::vector<std::array<std::int32_t, 3>> coefficient_;
  std::vector<std::int32_t> node_of_; ///< (unknowns)
  std::int64_t num_nodes_ = 0;
  std::vector<std::array<std::int32_t, 3>> cell_span_; ///< (cells)
  std::vector<std::int64_t> cell_offsets_;             ///< (cells + 1)
  std::vector<std::int32_t> cell_unknowns_;
  std::vector<char> cell_held_; ///< (cells)
};

/// Nodes of a block at most: of held cells with more each part makes one.
constexpr std::size_t most_in_block = 128;

/// Nodes that are solved for together (Multigrid), block after block; ascending within a block, each at least once.
struct NodeBlocks {
  std::vector<std::int64_t> offsets; ///< (blocks + 1)
  std::vector<std::int32_t> nodes;
  std::int64_t size() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
};

struct SplineHierarchy {
  std::vector<Transfer> transfers; ///< from the finest level down
  std::vector<NodeBlocks> blocks;  ///< of each level but the coarsest
};

/// Levels of a system down to one of at most `few` nodes, or to where coarser grids hardly have fewer nodes. The bodies
/// of a system are coarsened side by side. Blocks are boxes of p + 1 functions along each edge, four at most, and all
/// functions of each held cell: where a stiff support asks for zero, only these together have motions left that are
/// soft.
/// @param held  cells under supports and ties, by body; may be empty
SplineHierarchy spline_hierarchy(const BodySystem& system, std::int64_t few,
                                 std::span<const std::vector<std::int64_t>> held = {});

} // namespace iga::solve
