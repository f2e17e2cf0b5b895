#include "solver/space/tensor_gradients.hpp"

#include "format/model/bspline_basis.hpp"

#include <cmath>

namespace iga::solve {

bool as_tensor(const SpanPoints& points, TensorPoints& tensor) {
  constexpr double rounding = 1e-13;
  const auto& u = points.parameters;
  const auto& w = points.weights;
  const std::size_t total = w.size();
  if (total == 0) return false;
  // The first row and the first plane end where the next coordinate changes.
  std::size_t row = 1, plane = 1;
  while (row < total && u[3 * row + 1] == u[1] && u[3 * row + 2] == u[2]) ++row;
  while (plane < total && u[3 * plane + 2] == u[2]) ++plane;
  if (plane % row != 0 || total % plane != 0) return false;
  const std::array<std::size_t, 3> count{row, plane / row, total / plane}, step{1, row, plane};
  for (std::size_t d = 0; d < 3; ++d) {
    tensor.position[d].resize(count[d]);
    tensor.weight[d].resize(count[d]);
    for (std::size_t i = 0; i < count[d]; ++i) {
      tensor.position[d][i] = u[3 * i * step[d] + d];
      tensor.weight[d][i] = d == 0 ? w[i] : w[i * step[d]] / w[0];
    }
  }
  std::size_t q = 0;
  for (std::size_t k = 0; k < count[2]; ++k)
    for (std::size_t j = 0; j < count[1]; ++j)
      for (std::size_t i = 0; i < count[0]; ++i, ++q)
        if (u[3 * q] != tensor.position[0][i] || u[3 * q + 1] != tensor.position[1][j] ||
            u[3 * q + 2] != tensor.position[2][k] ||
            std::abs(tensor.weight[0][i] * tensor.weight[1][j] * tensor.weight[2][k] - w[q]) > rounding * w[q])
          return false;
  return true;
}

GradientProducts::GradientProducts(const SplineGrid& grid, std::int64_t span, const TensorPoints& tensor)
    : is_rotated_(grid.rotation() != identity_rotation) {
  const Index3 ijk = grid.span_index(span);
  double N[2][max_degree + 1];
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = grid.knots(static_cast<int>(d));
    const auto n = static_cast<std::size_t>(knots.degree()) + 1;
    n_[d] = static_cast<Eigen::Index>(n);
    for (std::size_t q = 0; q < tensor.position[d].size(); ++q) {
      evaluate_basis(knots, ijk[d], tensor.position[d][q], {N[0], n});
      evaluate_basis_derivatives(knots, ijk[d], tensor.position[d][q], {N[1], n});
      for (std::size_t alpha = 0; alpha < 2; ++alpha)
        for (std::size_t beta = 0; beta < 2; ++beta)
          for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b < n; ++b)
              sums_[d][alpha][beta][a][b] += tensor.weight[d][q] * N[alpha][a] * N[beta][b];
    }
    for (std::size_t c = 0; c < 3; ++c)
      R_(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(c)) = grid.rotation()[d][c];
  }
}

} // namespace iga::solve
