#include "solver/stress/equilibrated_polynomials.hpp"

#include "solver/base/dense_algebra.hpp"

#include <algorithm>

namespace iga::solve {

using Eigen::Index;
using Eigen::MatrixXd;

EquilibratedPolynomials::EquilibratedPolynomials(const SplineGrid& grid, const ElasticMaterial& material, int degree)
    : C_(material.C), first_{0} {
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t d = 0; d < 3; ++d)
      to_space_(static_cast<Index>(b), static_cast<Index>(d)) = grid.rotation()[b][d] / grid.span_size()[d];
  // Div C ε takes all polynomials of one degree onto all of two degrees less, and the strain 9 linear fields onto 6
  // strains: ranks are known.
  add_part(1, right_singular(linear_strains()).vectors.leftCols(6));
  for (int k = 2; k <= degree; ++k) {
    const MatrixXd A = divergence(k);
    add_part(k, right_singular(A).vectors.rightCols(A.cols() - A.rows()));
  }
}

std::vector<EquilibratedPolynomials::Exponents> EquilibratedPolynomials::monomials_of(int degree) {
  std::vector<Exponents> all;
  for (int a = degree; a >= 0; --a)
    for (int b = degree - a; b >= 0; --b) all.push_back({a, b, degree - a - b});
  return all;
}

void EquilibratedPolynomials::add_part(int degree, const MatrixXd& fields) {
  Part part;
  part.monomials = monomials_of(degree);
  const auto n = static_cast<Index>(part.monomials.size());
  for (Index c = 0; c < 3; ++c) {
    MatrixXd& of = part.fields[static_cast<std::size_t>(c)];
    of.resize(n, fields.cols());
    for (Index m = 0; m < n; ++m) of.row(m) = fields.row(3 * m + c);
  }
  first_.push_back(first_.back() + fields.cols());
  parts_.push_back(std::move(part));
}

MatrixXd EquilibratedPolynomials::divergence(int degree) const {
  // acoustic[d][e](i, k): factor of ∂²u_k / ∂s_d ∂s_e in (div σ)_i.
  Eigen::Matrix3d acoustic[3][3];
  for (int d = 0; d < 3; ++d)
    for (int e = 0; e < 3; ++e)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          double sum = 0;
          for (int j = 0; j < 3; ++j)
            for (int l = 0; l < 3; ++l)
              sum += C_(voigt_place[i][j], voigt_place[k][l]) * to_space_(j, d) * to_space_(l, e);
          acoustic[d][e](i, k) = sum;
        }
  const std::vector<Exponents> from = monomials_of(degree), to = monomials_of(degree - 2);
  MatrixXd A = MatrixXd::Zero(3 * static_cast<Index>(to.size()), 3 * static_cast<Index>(from.size()));
  for (std::size_t m = 0; m < from.size(); ++m)
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) {
        Exponents rest = from[m];
        double factor = rest[d]--;
        factor *= rest[e]--;
        if (factor == 0) continue; // a power fell below 0
        const auto row = std::find(to.begin(), to.end(), rest) - to.begin();
        A.block<3, 3>(3 * row, 3 * static_cast<Index>(m)) += factor * acoustic[d][e];
      }
  return A;
}

// (6 × 9); the monomials of degree 1 are s_1, s_2, s_3.
MatrixXd EquilibratedPolynomials::linear_strains() const {
  MatrixXd B = MatrixXd::Zero(6, 9);
  for (Index d = 0; d < 3; ++d)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) B(voigt_place[a][b], 3 * d + a) += to_space_(b, d);
  return B;
}

std::array<MatrixXd, 3> EquilibratedPolynomials::gradients(const Eigen::MatrixX3d& s,
                                                           const std::vector<Exponents>& monomials) const {
  const auto count = static_cast<Index>(monomials.size());
  std::array<MatrixXd, 3> by;
  for (MatrixXd& one : by) one.resize(s.rows(), count);
  const int highest = degree() + 2; // the part of degree 2 of a force is asked for before there are others
  MatrixXd powers[3];
  for (Index d = 0; d < 3; ++d) {
    powers[d].resize(s.rows(), highest + 1);
    powers[d].col(0).setOnes();
    for (Index k = 1; k <= highest; ++k) powers[d].col(k) = powers[d].col(k - 1).cwiseProduct(s.col(d));
  }
  for (Index m = 0; m < count; ++m) {
    const Exponents& e = monomials[static_cast<std::size_t>(m)];
    Eigen::MatrixX3d slope = Eigen::MatrixX3d::Zero(s.rows(), 3);
    for (Index d = 0; d < 3; ++d) {
      const auto along = static_cast<std::size_t>(d), next = (along + 1) % 3, last = (along + 2) % 3;
      if (e[along] > 0)
        slope.col(d) = e[along] * powers[along]
                                      .col(e[along] - 1)
                                      .cwiseProduct(powers[next].col(e[next]).cwiseProduct(powers[last].col(e[last])));
    }
    for (Index b = 0; b < 3; ++b) by[static_cast<std::size_t>(b)].col(m) = slope * to_space_.row(b).transpose();
  }
  return by;
}

FieldStrains EquilibratedPolynomials::strains(const Eigen::MatrixX3d& s, int k) const {
  FieldStrains all;
  for (MatrixXd& one : all) one.setZero(s.rows(), size(k));
  for (std::size_t p = 0; p < static_cast<std::size_t>(k); ++p) {
    const Part& part = parts_[p];
    const auto by = gradients(s, part.monomials);
    const Index first = first_[p], count = first_[p + 1] - first;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        all[static_cast<std::size_t>(voigt_place[a][b])].middleCols(first, count).noalias() += by[b] * part.fields[a];
  }
  return all;
}

Eigen::Matrix<double, Eigen::Dynamic, 6> EquilibratedPolynomials::strains_of_force(const Eigen::MatrixX3d& s,
                                                                                   const LinearForce& b) const {
  Eigen::Matrix<double, Eigen::Dynamic, 6> strain = Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(s.rows(), 6);
  const auto add = [&](int degree, const Eigen::VectorXd& force) {
    const MatrixXd coefficients = least_squares(divergence(degree), -force); // 3 m + a
    const auto by = gradients(s, monomials_of(degree));
    for (int a = 0; a < 3; ++a) {
      Eigen::VectorXd component(coefficients.rows() / 3);
      for (Index m = 0; m < component.size(); ++m) component[m] = coefficients(3 * m + a, 0);
      for (int c = 0; c < 3; ++c) strain.col(voigt_place[a][c]) += by[static_cast<std::size_t>(c)] * component;
    }
  };
  add(2, b.constant);
  if (!b.slope.isZero()) add(3, b.slope.reshaped()); // the monomials of degree 1 are s_1, s_2, s_3
  return strain;
}

} // namespace iga::solve
