#include "solver/estimate/cell_residual.hpp"

#include <Eigen/LU>

namespace iga::solve {

using Eigen::Index;
using Eigen::MatrixXd;

const std::vector<CellMonomials::Orders> CellMonomials::value_parts{{0, 0, 0}};
const std::vector<CellMonomials::Orders> CellMonomials::gradient_parts{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<CellMonomials::Orders> CellMonomials::second_parts{{2, 0, 0}, {0, 2, 0}, {0, 0, 2},
                                                                     {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};

namespace {

// s^a, s = 2 ξ - 1, and its derivatives of order 0 … 2 by length at points of a direction: columns a.
std::array<MatrixXd, 3> powers(const Eigen::Ref<const Eigen::VectorXd>& xi, int degree, double h) {
  const Eigen::ArrayXd s = 2 * xi.array() - 1;
  const double slope = 2 / h;
  std::array<MatrixXd, 3> out;
  for (MatrixXd& order : out) order.setZero(xi.size(), degree + 1);
  for (int a = 0; a <= degree; ++a) {
    if (a == 0)
      out[0].col(0).setOnes();
    else
      out[0].col(a) = out[0].col(a - 1).array() * s;
    if (a >= 1) out[1].col(a) = a * slope * out[0].col(a - 1);
    if (a >= 2) out[2].col(a) = a * (a - 1) * slope * slope * out[0].col(a - 2);
  }
  return out;
}

} // namespace

CellMonomials::CellMonomials(const SplineGrid& grid) : grid_(grid) {
  const auto p = grid.degree();
  nodes_ = cube_rule({p[0] + 1, p[1] + 1, p[2] + 1}).points;
  inverse_ = table(nodes_, value_parts).inverse();
}

std::vector<double> CellMonomials::node_parameters(const Index3& span) const {
  const Box3 box = grid_.span_box(span);
  std::vector<double> parameters;
  for (Index q = 0; q < nodes_.rows(); ++q)
    for (std::size_t d = 0; d < 3; ++d)
      parameters.push_back(box.lower[d] + nodes_(q, static_cast<Index>(d)) * (box.upper[d] - box.lower[d]));
  return parameters;
}

CellFields CellMonomials::fields(const SolutionSpace& space, std::int64_t a, const Eigen::Ref<const MatrixXd>& unknowns,
                                 SpanShapes& shapes) const {
  const Index3 span = grid_.span_index(space.model().cells.span[static_cast<std::size_t>(a)]);
  evaluate(space, a, node_parameters(span), Shapes::Values, shapes);
  const auto nodes = space.nodes(a);
  const Rotation& R = grid_.rotation();
  MatrixXd coefficients(static_cast<Index>(nodes.size()), 3 * unknowns.cols());
  for (std::size_t r = 0; r < nodes.size(); ++r)
    for (Index k = 0; k < unknowns.cols(); ++k)
      for (std::size_t d = 0; d < 3; ++d) {
        double along = 0;
        for (std::size_t e = 0; e < 3; ++e) along += R[e][d] * unknowns(3 * nodes[r] + static_cast<Index>(e), k);
        coefficients(static_cast<Index>(r), 3 * k + static_cast<Index>(d)) = along;
      }
  return inverse_ * (shapes.values * coefficients);
}

Eigen::MatrixX3d CellMonomials::local(const Index3& span, std::span<const double> parameters) const {
  const Box3 box = grid_.span_box(span);
  Eigen::MatrixX3d xi(static_cast<Index>(parameters.size() / 3), 3);
  for (Index q = 0; q < xi.rows(); ++q)
    for (std::size_t d = 0; d < 3; ++d)
      xi(q, static_cast<Index>(d)) =
          (parameters[3 * static_cast<std::size_t>(q) + d] - box.lower[d]) / (box.upper[d] - box.lower[d]);
  return xi;
}

MatrixXd CellMonomials::table(const Eigen::MatrixX3d& xi, const std::vector<Orders>& parts) const {
  const auto p = grid_.degree();
  const Index n = xi.rows();
  std::array<std::array<MatrixXd, 3>, 3> power; // by direction and order of the derivative; (points × degree + 1)
  for (std::size_t d = 0; d < 3; ++d) power[d] = powers(xi.col(static_cast<Index>(d)), p[d], grid_.span_size()[d]);
  const Index size = (p[0] + 1) * (p[1] + 1) * (p[2] + 1);
  MatrixXd out(n, size * static_cast<Index>(parts.size()));
  if (n == 0) return out;
  double* to = out.data();
  for (const Orders& order : parts) {
    const MatrixXd &u = power[0][order[0]], &v = power[1][order[1]], &w = power[2][order[2]];
    for (Index c = 0; c <= p[2]; ++c)
      for (Index b = 0; b <= p[1]; ++b)
        for (Index a = 0; a <= p[0]; ++a, to += n) {
          const double *x = &u(0, a), *y = &v(0, b), *z = &w(0, c);
          for (Index q = 0; q < n; ++q) to[q] = x[q] * y[q] * z[q];
        }
  }
  return out;
}

} // namespace iga::solve
