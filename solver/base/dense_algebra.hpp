// Decompositions of small dense matrices that several files need. Each is instantiated once, in dense_algebra.cpp: a
// single instance of Eigen's eigenvalue or singular value iteration takes as long to compile as ten ordinary files.
#pragma once

#include <Eigen/Core>

namespace iga::solve {

/// Eigenpairs of a symmetric matrix of size n, eigenvalues ascending.
struct SymmetricEigen {
  Eigen::VectorXd values;  ///< (n)
  Eigen::MatrixXd vectors; ///< (n × n), columns, orthonormal (B-orthonormal for a pair of matrices)
};

/// All eigenpairs of the symmetric matrix A (n × n; only its lower triangle is read).
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);

/// All eigenpairs of A x = λ B x; A symmetric, B symmetric and positive definite (both n × n; lower triangles are
/// read).
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Eigenvalues, ascending, of the symmetric matrix A (n × n; only its lower triangle is read).
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A);

/// The same for 3 × 3: no memory is allocated.
struct SymmetricEigen3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
SymmetricEigen3 symmetric_eigen_3(const Eigen::Matrix3d& A);
Eigen::Vector3d symmetric_eigenvalues_3(const Eigen::Matrix3d& A);

/// Singular values of A (m × n), descending, and all n right singular vectors as columns.
struct RightSingular {
  Eigen::VectorXd values;  ///< (min(m, n))
  Eigen::MatrixXd vectors; ///< (n × n)
};
RightSingular right_singular(const Eigen::MatrixXd& A);

/// The shortest X that minimises |A X - B|, column by column.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

} // namespace iga::solve
