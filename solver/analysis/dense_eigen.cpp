#include "solver/analysis/dense_eigen.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/linalg/system_columns.hpp"

#include <fmt/format.h>

#include <limits>

// LAPACK's own interface (Fortran), as OpenBLAS brings it; its header is not part of every installation.
extern "C" void dsygvd_(const int* itype, const char* jobz, const char* uplo, const int* n, double* a, const int* lda,
                        double* b, const int* ldb, double* w, double* work, const int* lwork, int* iwork,
                        const int* liwork, int* info);

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// S (K - σ M) S, lower triangle; S makes its diagonal one.
MatrixXd full(const SystemColumns& columns) {
  MatrixXd A = MatrixXd::Zero(columns.size(), columns.size());
  for (Index j = 0; j < A.cols(); ++j)
    for (auto k = static_cast<std::size_t>(columns.offsets[static_cast<std::size_t>(j)]);
         k < static_cast<std::size_t>(columns.offsets[static_cast<std::size_t>(j) + 1]); ++k)
      A(columns.rows[k], j) = columns.values[k];
  return A;
}

// S (M - (M F) (M F)ᵀ) S, lower triangle.
MatrixXd full_mass(const MassOperator& mass, const VectorXd& scale, const MatrixXd& mass_free) {
  MatrixXd A = MatrixXd::Zero(mass.size(), mass.size());
  const auto add = [&](Index i, Index j, double value) {
    for (Index d = 0; d < 3; ++d) A(3 * i + d, 3 * j + d) = value * scale[3 * i + d] * scale[3 * j + d];
  };
  if (mass.is_consistent()) {
    const NodePattern& pattern = mass.matrix()->pattern();
    for (std::int64_t j = 0; j < pattern.num_nodes(); ++j)
      for (auto k = static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j)]);
           k < static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j) + 1]); ++k)
        add(pattern.rows[k], j, mass.matrix()->values()[k]);
  } else {
    for (Index i = 0; i < mass.masses()->size(); ++i) add(i, i, (*mass.masses())[i]);
  }
  if (mass_free.cols() == 0) return A; // a held part; Eigen divides by the number of columns
  const MatrixXd taken = scale.asDiagonal() * mass_free;
  A.triangularView<Eigen::Lower>() -= taken * taken.transpose();
  return A;
}

} // namespace

double dense_bytes(std::int64_t unknowns) {
  const auto n = static_cast<double>(unknowns);
  return 8 * (5 * n * n + 100 * n); // two matrices, 1 + 6 n + 2 n² of work space, the vectors given back
}

MatrixXd dense_modes(const EigenProblem& problem, double shift, const MatrixXd& mass_free, int wanted) {
  SystemMatrix system;
  system.stiffness = problem.stiffness;
  system.shift = shift;
  if (problem.mass->is_consistent())
    system.mass = problem.mass->matrix();
  else
    system.lumped_mass = problem.mass->masses();
  const SystemColumns columns = scaled_columns(system);
  MatrixXd B = full(columns), A = full_mass(*problem.mass, columns.scale, mass_free);
  const int n = static_cast<int>(A.rows()), itype = 1, query = -1;
  VectorXd theta(n);
  double work_size = 0;
  int integer_size = 0, info = 0;
  follow_run_threads();
  dsygvd_(&itype, "V", "L", &n, A.data(), &n, B.data(), &n, theta.data(), &work_size, &query, &integer_size, &query,
          &info);
  VectorXd work(static_cast<Index>(work_size));
  std::vector<int> integers(static_cast<std::size_t>(integer_size));
  const int size = static_cast<int>(work.size());
  dsygvd_(&itype, "V", "L", &n, A.data(), &n, B.data(), &n, theta.data(), work.data(), &size, integers.data(),
          &integer_size, &info);
  if (info != 0)
    throw NumericalError(fmt::format("the dense eigenvalue solver failed (LAPACK dsygvd {}): functions on slivers are "
                                     "dependent to rounding; ask for fewer modes, or use smaller spans",
                                     info));
  // Directions without mass have θ = 0: no frequency.
  const double massless = 100 * n * std::numeric_limits<double>::epsilon() * theta[n - 1];
  Index found = 0;
  while (found < std::min(n, wanted) && theta[n - 1 - found] > massless) ++found;
  return columns.scale.asDiagonal() * A.rightCols(found).rowwise().reverse();
}

} // namespace iga::solve
