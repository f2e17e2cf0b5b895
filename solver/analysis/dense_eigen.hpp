// Eigenpairs of small systems, or of many modes of larger ones, from full matrices by LAPACK.
#pragma once

#include "solver/analysis/eigen_solver.hpp"

namespace iga::solve {

/// Bytes that dense_modes takes for a system of this size.
double dense_bytes(std::int64_t unknowns);

/// The eigenvectors of lowest ω² of K x = ω² M x beside the free motions; (num_unknowns × found), ascending ω². Fewer
/// than wanted where the mass has fewer dimensions. No constraints, a mass of one pass.
/// From M x = θ (K - σ M) x with θ = 1 / (ω² - σ), σ < 0: positive definite on the right whatever M's rank; the free
/// motions are taken out of M (Hotelling's deflation). Divide and conquer: LAPACK's dsygvd.
/// @param mass_free  (num_unknowns × r): M times the M-orthonormal free motions
/// @throws NumericalError where K - σ M is not positive definite to rounding
Eigen::MatrixXd dense_modes(const EigenProblem& problem, double shift, const Eigen::MatrixXd& mass_free, int wanted);

} // namespace iga::solve
