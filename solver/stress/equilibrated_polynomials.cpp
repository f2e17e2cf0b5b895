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
  first_.push_back(first_.back() + fields.cols());
  strains_.push_back(strains_of(degree, fields));
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

FieldStrains EquilibratedPolynomials::strains_of(int degree, const MatrixXd& fields) const {
  const std::vector<Exponents> from = monomials_of(degree), to = monomials_of(degree - 1);
  FieldStrains all;
  for (MatrixXd& one : all) one.setZero(static_cast<Index>(to.size()), fields.cols());
  for (std::size_t m = 0; m < from.size(); ++m)
    for (std::size_t d = 0; d < 3; ++d) {
      Exponents slope = from[m];
      const double factor = slope[d]--;
      if (factor == 0) continue;
      const Index row = std::find(to.begin(), to.end(), slope) - to.begin();
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          all[static_cast<std::size_t>(voigt_place[a][b])].row(row) +=
              factor * to_space_(b, static_cast<Index>(d)) * fields.row(3 * static_cast<Index>(m) + a);
    }
  return all;
}

MatrixXd EquilibratedPolynomials::monomials(const Eigen::MatrixX3d& s, int k) {
  MatrixXd all(s.rows(), num_monomials(k));
  all.col(0).setOnes();
  // As monomials_of lists them: those of the degree before times s_1, then those without s_1 times s_2, then one of
  // s_3.
  for (int degree = 1; degree <= k; ++degree) {
    const Index before = num_monomials(degree - 2), first = num_monomials(degree - 1), count = first - before;
    for (Index m = 0; m < count; ++m) all.col(first + m) = all.col(before + m).cwiseProduct(s.col(0));
    for (Index m = 0; m < degree; ++m) all.col(first + count + m) = all.col(first - degree + m).cwiseProduct(s.col(1));
    all.col(first + count + degree) = all.col(first - 1).cwiseProduct(s.col(2));
  }
  return all;
}

VoigtPolynomial EquilibratedPolynomials::strain(const Eigen::VectorXd& factors) const {
  int k = 0;
  while (size(k) < factors.size()) ++k;
  VoigtPolynomial all(num_monomials(k - 1), 6);
  for (int part = 1; part <= k; ++part) {
    const FieldStrains& of_fields = strains_of_degree(part);
    const Index first = num_monomials(part - 2);
    for (std::size_t c = 0; c < 6; ++c)
      all.col(static_cast<Index>(c)).segment(first, of_fields[c].rows()) =
          of_fields[c] * factors.segment(size(part - 1), of_fields[c].cols());
  }
  return all;
}

VoigtPolynomial EquilibratedPolynomials::strain_of_force(const LinearForce& b) const {
  VoigtPolynomial all = VoigtPolynomial::Zero(num_monomials(2), 6);
  const auto add = [&](int degree, const Eigen::VectorXd& force) {
    const FieldStrains strain = strains_of(degree, least_squares(divergence(degree), -force));
    for (std::size_t c = 0; c < 6; ++c)
      all.col(static_cast<Index>(c)).segment(num_monomials(degree - 2), strain[c].rows()) = strain[c];
  };
  add(2, b.constant);
  if (!b.slope.isZero()) add(3, b.slope.reshaped()); // the monomials of degree 1 are s_1, s_2, s_3
  return all;
}

FieldStrains EquilibratedPolynomials::strains(const Eigen::MatrixX3d& s, int k) const {
  const MatrixXd at = monomials(s, k - 1);
  FieldStrains all;
  for (MatrixXd& one : all) one.resize(s.rows(), size(k));
  for (int part = 1; part <= k; ++part)
    for (std::size_t c = 0; c < 6; ++c) {
      const MatrixXd& of_fields = strains_of_degree(part)[c];
      all[c].middleCols(size(part - 1), of_fields.cols()).noalias() =
          at.middleCols(num_monomials(part - 2), of_fields.rows()) * of_fields;
    }
  return all;
}

} // namespace iga::solve
