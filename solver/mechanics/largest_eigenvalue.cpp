#include "solver/mechanics/largest_eigenvalue.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/lanczos.hpp"

#include <fmt/format.h>

#include <cmath>

namespace iga::solve {

// With forces f = M x as unknowns the problem K M⁻¹ f = ω² f is symmetric in the inner product fᵀ M⁻¹ f: the mass
// itself, which has no cheap product under several passes, is never needed.
LargestEigenvalue largest_eigenvalue(const StiffnessMatrix& K, const MassOperator& M, double tolerance) {
  LanczosProblem problem;
  problem.size = M.size();
  problem.F = [&](const double* x, double* f, int columns) {
    for (int c = 0; c < columns; ++c) K.multiply(x + c * M.size(), f + c * M.size());
  };
  problem.B = [&](const double* f, double* x, int columns) { M.divide(f, x, columns); };
  problem.start_scale = M.inverse_root_scale().unaryExpr([](double r) { return r > 0 ? 1 / r : 0.0; });
  // A Ritz value is off by the square of its residual over the gap to the next one: a residual of √tolerance will do
  // where the gap is wide; a thousandth of that keeps the promise in clusters down to relative gaps of 1e-6.
  const double residual = tolerance > 1e-4 ? tolerance : std::max(1e-3 * std::sqrt(tolerance), 1e-11);
  const LanczosResult found =
      block_lanczos(problem, {.wanted = 1, .block = 1, .max_basis = 120, .tolerance = residual, .max_restarts = 200});
  if (!found.converged || found.theta.size() == 0)
    throw NumericalError(fmt::format("the largest eigenfrequency did not converge in {} products", found.applied));
  LargestEigenvalue largest;
  largest.omega = std::sqrt(std::max(0.0, found.theta[0]));
  largest.residual = found.estimate[0] / found.theta[0];
  largest.products = found.applied;
  largest.mode.resize(M.size());
  M.divide(found.vectors.data(), largest.mode.data(), 1);
  return largest;
}

} // namespace iga::solve
