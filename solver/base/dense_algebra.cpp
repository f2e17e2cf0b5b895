#include "solver/base/dense_algebra.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace iga::solve {

using Eigen::MatrixXd;

namespace {

using Svd = Eigen::JacobiSVD<MatrixXd, Eigen::HouseholderQRPreconditioner>;

} // namespace

SymmetricEigen symmetric_eigen(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

SymmetricEigen symmetric_eigen(const MatrixXd& A, const MatrixXd& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(A, B);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen3 symmetric_eigen_3(const Eigen::Matrix3d& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::Vector3d symmetric_eigenvalues_3(const Eigen::Matrix3d& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

RightSingular right_singular(const MatrixXd& A) {
  const Svd svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

MatrixXd least_squares(const MatrixXd& A, const MatrixXd& B) {
  return Svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(B);
}

} // namespace iga::solve
