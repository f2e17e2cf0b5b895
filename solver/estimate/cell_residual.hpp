// The residual of many fields in one cell, tested with oscillations.
#pragma once

#include "solver/estimate/oscillation.hpp"
#include "solver/space/solution_space.hpp"

#include <array>
#include <vector>

namespace iga::solve {

/// Displacements of one cell as polynomials of its span, in the grid's axes: coefficients of the products
/// s_u^a s_v^b s_w^c, a fastest, of s = 2 ξ - 1 in -1 … 1; (monomials × 3 k), component fastest.
using CellFields = Eigen::MatrixXd;

/// Monomials of a grid's degree, their derivatives and the way from a cell's unknowns to them.
class CellMonomials {
 public:
  explicit CellMonomials(const SplineGrid& grid);

  Eigen::Index size() const { return inverse_.rows(); }
  /// @param unknowns  (space.num_unknowns() × k)
  CellFields fields(const SolutionSpace& space, std::int64_t a, const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                    SpanShapes& shapes) const;

  /// Points of a span, as many as monomials, where values determine a polynomial: units of the span, 0 … 1.
  const Eigen::MatrixX3d& nodes() const { return nodes_; }
  std::vector<double> node_parameters(const Index3& span) const;
  /// The polynomials with given values at the nodes: (monomials × columns).
  Eigen::MatrixXd through(const Eigen::Ref<const Eigen::MatrixXd>& nodal) const { return inverse_ * nodal; }

  /// What of each monomial at points: values, gradients (3) or second derivatives (6, order xx yy zz xy yz zx), with
  /// respect to lengths along the grid's axes; column monomials() * c + n holds part c of monomial n.
  Eigen::MatrixXd values(const Eigen::MatrixX3d& xi) const { return table(xi, value_parts); }
  Eigen::MatrixXd gradients(const Eigen::MatrixX3d& xi) const { return table(xi, gradient_parts); }
  Eigen::MatrixXd second_derivatives(const Eigen::MatrixX3d& xi) const { return table(xi, second_parts); }

  /// Points of a cell in units of its span, 0 … 1.
  Eigen::MatrixX3d local(const Index3& span, std::span<const double> parameters) const;

 private:
  using Orders = std::array<std::size_t, 3>; // of the derivative in each direction
  static const std::vector<Orders> value_parts, gradient_parts, second_parts;
  Eigen::MatrixXd table(const Eigen::MatrixX3d& xi, const std::vector<Orders>& parts) const;

  SplineGrid grid_;
  Eigen::MatrixX3d nodes_;  // where displacements are taken, units of the span
  Eigen::MatrixXd inverse_; // (monomials × nodes)
};

} // namespace iga::solve
