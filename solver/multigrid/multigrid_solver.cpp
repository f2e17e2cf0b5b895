#include "solver/multigrid/multigrid_solver.hpp"

#include "format/io/interrupt.hpp"
#include "format/io/progress.hpp"
#include "format/model/errors.hpp"
#include "solver/linalg/product_rounding.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

using Eigen::VectorXd;

MultigridSolver::MultigridSolver(const ShiftedStiffness& A, const BodySystem& system, io::Progress* progress,
                                 const MultigridSettings& settings, std::span<const std::vector<std::int64_t>> held)
    : A_(A), multigrid_(A, system, settings, held), progress_(progress) {}

void MultigridSolver::solve(const double* b, double* x, int columns) const {
  for (int c = 0; c < columns; ++c) {
    Eigen::Map<VectorXd> solution(x + c * size(), size());
    steps_ = std::max(steps_, conjugate_gradients(Eigen::Map<const VectorXd>(b + c * size(), size()), solution));
  }
}

void MultigridSolver::multiply(const VectorXd& x, VectorXd& y) const {
  A_.stiffness->multiply(x.data(), y.data());
  if (!A_.mass || A_.shift == 0) return;
  y -= A_.shift * (*A_.mass * x);
}

// Polak and Ribière's form: the cycle is symmetric but for the rounding of single precision.
int MultigridSolver::conjugate_gradients(const VectorXd& b, Eigen::Ref<VectorXd> x) const {
  x.setZero();
  const double size_of_b = b.norm();
  if (size_of_b == 0) return 0;
  VectorXd r = b, z(size()), p, Ap(size()), before;
  double rz = 0;
  for (int step = 1; step <= most_steps; ++step) {
    io::stop_if_interrupted();
    multigrid_.apply(r.data(), z.data(), 1);
    const double next = r.dot(z);
    if (!(next > 0))
      throw NumericalError("the multigrid cycle is not positive definite: the part is hardly held, or functions hold "
                           "almost no material; use solver = \"direct\"");
    if (step == 1)
      p = z;
    else
      p = z + ((next - before.dot(z)) / rz) * p;
    rz = next;
    multiply(p, Ap);
    const double alpha = r.dot(p) / p.dot(Ap);
    x += alpha * p;
    before = r;
    r -= alpha * Ap;
    const double left = r.norm();
    if (progress_) progress_->update(step, most_steps);
    if (left <= tolerance * size_of_b) return step;
    if (!std::isfinite(left)) break;
  }
  throw NumericalError(fmt::format("the multigrid solver left a residual of {:.2g} after {} steps, expected {:g}: the "
                                   "part is hardly held, or functions hold almost no material; use solver = "
                                   "\"direct\" or larger light_threshold",
                                   r.norm() / size_of_b, most_steps, tolerance));
}

} // namespace iga::solve
