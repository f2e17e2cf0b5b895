#include "solver/nonlinear/mean_volume.hpp"

#include <cmath>

namespace iga::solve {

namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

// ∂ cof F / ∂F.
Matrix9 cofactor_derivative(const Vector9& F) {
  Matrix9 D = Matrix9::Zero();
  for (int a = 0; a < 3; ++a)
    for (int A = 0; A < 3; ++A)
      for (int s = 1; s < 3; ++s)
        for (int t = 1; t < 3; ++t) { // cof_aA = ± F_bB F_cC with b, c the rows after a, B, C the columns after A
          const int b = (a + s) % 3, B = (A + t) % 3, c = 3 - a - b, C = 3 - A - B;
          D(3 * a + A, 3 * b + B) = s == t ? F[3 * c + C] : -F[3 * c + C];
        }
  return D;
}

} // namespace

void MeanVolume::set(std::span<const double> weights, const Eigen::MatrixXd& H) {
  const Eigen::Index points = H.rows();
  weights_ = Eigen::Map<const Eigen::VectorXd>(weights.data(), points);
  volume_ = weights_.sum();
  F_ = H;
  for (const int k : {0, 4, 8}) F_.col(k).array() += 1;
  cof_.resize(points, 9);
  for (int a = 0; a < 3; ++a)
    for (int A = 0; A < 3; ++A) {
      const int b = (a + 1) % 3, c = (a + 2) % 3, B = (A + 1) % 3, C = (A + 2) % 3;
      cof_.col(3 * a + A) =
          F_.col(3 * b + B).cwiseProduct(F_.col(3 * c + C)) - F_.col(3 * b + C).cwiseProduct(F_.col(3 * c + B));
    }
  J_ = F_.leftCols(3).cwiseProduct(cof_.leftCols(3)).rowwise().sum();
  theta_ = mean(J_);
  crushed_ = !(J_.minCoeff() > 0);
  scale_ = Eigen::VectorXd::Ones(points);
  if (!crushed_)
    for (Eigen::Index q = 0; q < points; ++q) scale_[q] = std::cbrt(theta_ / J_[q]);
}

Eigen::VectorXd MeanVolume::mean_stress(const Eigen::MatrixXd& P) const {
  return P.cwiseProduct(F_).rowwise().sum().cwiseProduct(scale_) / 3;
}

void MeanVolume::to_stress(Eigen::MatrixXd& P) const {
  const Eigen::VectorXd s = mean_stress(P);
  const double tau = mean(s) / theta_;
  P = scale_.asDiagonal() * P;
  P += (tau - s.array() / J_.array()).matrix().asDiagonal() * cof_;
}

void MeanVolume::to_tangent(const Eigen::MatrixXd& P, Eigen::MatrixXd& A, Linear& linear) const {
  const Eigen::VectorXd s = mean_stress(P);
  const double theta = theta_, tau = mean(s) / theta;
  linear.V.resize(A.rows(), 9);
  linear.R.resize(A.rows(), 9);
  linear.c = -tau / theta;
  for (Eigen::Index q = 0; q < A.rows(); ++q) {
    const double a = scale_[q], J = J_[q];
    const Vector9 Pq = P.row(q), Fq = F_.row(q), cof = cof_.row(q), F_bar = a * Fq;
    Matrix9 M;
    for (int i = 0; i < 9; ++i)
      for (int k = 0; k < 9; ++k) M(i, k) = A(q, 9 * i + k);
    // dF̄ = T dF + g dθ with T = a - F̄ ⊗ cof/(3 J), g = F̄/(3 θ);   ds = m : dF̄.
    const Vector9 MF = M.lazyProduct(F_bar), m = (M.transpose().lazyProduct(F_bar) + Pq) / 3;
    const double mF = m.dot(F_bar), mg = mF / (3 * theta);
    const Vector9 mT = a * m - cof * (mF / (3 * J));
    Matrix9 whole = a * a * M;
    whole -= (a / (3 * J)) * (MF + Pq) * cof.transpose();
    whole -= cof * mT.transpose() / J;
    whole += (s[q] / (J * J)) * cof * cof.transpose();
    whole += (tau - s[q] / J) * cofactor_derivative(Fq);
    for (int i = 0; i < 9; ++i)
      for (int k = 0; k < 9; ++k) A(q, 9 * i + k) = whole(i, k);
    linear.V.row(q) = (a / (3 * theta)) * (MF + Pq) - cof * (mg / J);
    linear.R.row(q) = mT / theta;
    linear.c += weights_[q] / volume_ * mg / theta;
  }
}

} // namespace iga::solve
