#include "preprocessor/fit/moment_equations.hpp"

#include "preprocessor/base/gauss_rule.hpp"

namespace iga::prep {

namespace {

using Values = double[3][max_moment_degree + 1];

enum class Store { Set, Add };

// out (+)= scale · A(a) B(b) C(c), a fastest.
template <Store store>
void product(const std::array<int, 3>& q, double scale, const double* A, const double* B, const double* C,
             double* out) {
  for (int c = 0; c <= q[2]; ++c) {
    const double sc = scale * C[c];
    for (int b = 0; b <= q[1]; ++b) {
      const double sbc = sc * B[b];
      for (int a = 0; a <= q[0]; ++a, ++out) *out = sbc * A[a] + (store == Store::Add ? *out : 0);
    }
  }
}

} // namespace

void MomentEquations::start(const std::array<int, 3>& degree, std::span<const double> moments, int fixed_axis) {
  degree_ = degree;
  b_ = moments;
  norm_ = Eigen::Map<const Eigen::VectorXd>(b_.data(), num_moments()).norm();
  unknowns_ = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    moves_[d] = static_cast<int>(d) != fixed_axis;
    unknowns_ += moves_[d];
  }
}

void MomentEquations::residual(std::span<const double> x, std::span<const double> w, Eigen::VectorXd& r) const {
  r = -Eigen::Map<const Eigen::VectorXd>(b_.data(), num_moments());
  Values P;
  for (std::size_t k = 0; k < w.size(); ++k) {
    for (std::size_t d = 0; d < 3; ++d) legendre(x[3 * k + d], degree_[d], P[d]);
    product<Store::Add>(degree_, w[k], P[0], P[1], P[2], r.data());
  }
}

void MomentEquations::jacobian(const PointSet& points, std::span<const UnknownScale> scale, Eigen::MatrixXd& J) const {
  const Eigen::Index m = num_moments();
  J.resize(m, unknowns_ * static_cast<Eigen::Index>(points.size()));
  Values P, D;
  double* out = J.data();
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      legendre(points.x[3 * k + d], degree_[d], P[d]);
      legendre_slopes(degree_[d], P[d], D[d]);
    }
    product<Store::Set>(degree_, scale[k].weight, P[0], P[1], P[2], out);
    out += m;
    for (std::size_t d = 0; d < 3; ++d) {
      if (!moves_[d]) continue;
      product<Store::Set>(degree_, scale[k].place * points.w[k], d == 0 ? D[0] : P[0], d == 1 ? D[1] : P[1],
                          d == 2 ? D[2] : P[2], out);
      out += m;
    }
  }
}

double relative_residual(const std::array<int, 3>& degree, std::span<const double> moments,
                         std::span<const double> points, std::span<const double> weights) {
  MomentEquations equations;
  equations.start(degree, moments, -1);
  if (equations.norm() == 0) return 0;
  Eigen::VectorXd r;
  equations.residual(points, weights, r);
  return r.norm() / equations.norm();
}

} // namespace iga::prep
