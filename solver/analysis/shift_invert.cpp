#include "solver/analysis/shift_invert.hpp"

#include "solver/linalg/stage_progress.hpp"

#include <cmath>

namespace iga::solve {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ShiftInvert::ShiftInvert(const EigenProblem& problem, double shift) : problem_(problem), shift_(shift) {
  SystemMatrix system;
  system.stiffness = problem.stiffness;
  system.shift = shift;
  system.announce = show_factorisation(problem.progress);
  if (problem.mass->is_consistent())
    system.mass = problem.mass->matrix();
  else
    system.lumped_mass = problem.mass->masses();
  system.constraints = problem.constraints;
  factor_ = std::make_unique<ConstrainedSolver>(system);
}

void ShiftInvert::apply(const double* F, double* X, int columns) const {
  if (problem_.mass->passes() == 1) {
    factor_->solve(F, X, columns);
    if (factor_->added_to_diagonal() > 0) refine(F, X, columns);
    return;
  }
  const auto n = problem_.mass->size();
  for (int c = 0; c < columns; ++c) conjugate_gradients(F + c * n, X + c * n);
}

// X += (K - σ M + δ)⁻¹ (F - (K - σ M) X), a fixed number of times: a polynomial of the factor's inverse and the matrix,
// hence as symmetric as they are. A motion whose scaled energy is k is wrong by (δ / (k + δ))^(steps + 1) afterwards.
void ShiftInvert::refine(const double* F, double* X, int columns) const {
  constexpr int steps = 4;
  const auto n = problem_.mass->size();
  Map<MatrixXd> solution(X, n, columns);
  MatrixXd correction(n, columns); // constraints hold for it too: solve_factor gives back motions that obey them
  for (int step = 0; step < steps; ++step) {
    const MatrixXd defect = Map<const MatrixXd>(F, n, columns) - columns_of(*problem_.stiffness, solution) +
                            shift_ * columns_of(*problem_.mass, solution);
    factor_->solve(defect.data(), correction.data(), columns);
    solution += correction;
  }
}

void ShiftInvert::apply_refined(const double* F, double* X, int columns) const {
  apply(F, X, columns);
  if (problem_.mass->passes() == 1 && factor_->added_to_diagonal() == 0) refine(F, X, columns);
}

void ShiftInvert::conjugate_gradients(const double* f, double* x) const {
  constexpr int most_steps = 200;
  constexpr double tolerance = 1e-13; // in the energy norm: four digits more than Lanczos asks of its vectors
  const auto n = problem_.mass->size();
  Map<VectorXd> X(x, n);
  VectorXd r = Map<const VectorXd>(f, n), z(n), p, Ap(n), Mp(n);
  X.setZero();
  factor_->solve(r.data(), z.data(), 1);
  p = z;
  double rz = r.dot(z);
  const double small = tolerance * tolerance * rz;
  for (int step = 0; step < most_steps && rz > small; ++step) {
    problem_.stiffness->multiply(p.data(), Ap.data());
    problem_.mass->multiply(p.data(), Mp.data(), 1);
    Ap -= shift_ * Mp;
    const double alpha = rz / p.dot(Ap);
    X += alpha * p;
    r -= alpha * Ap;
    factor_->solve(r.data(), z.data(), 1);
    const double next = r.dot(z);
    p = z + (next / rz) * p;
    rz = next;
  }
}

} // namespace iga::solve
