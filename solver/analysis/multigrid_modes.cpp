#include "solver/analysis/multigrid_modes.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/mode_sign.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/multigrid/lobpcg.hpp"
#include "solver/multigrid/multigrid.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <random>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The cycle is that of K - σ M with σ = -0.001 (π c_S / L)²: rigid motions must not make it singular.
constexpr double shift_share = 1e-3;
// ω² / λ_scale of what may be a mechanism.
constexpr double mechanism_guess = 1e-9;
// A next Ritz value as near as this may belong to the last mode's multiplet: it has not converged.
constexpr double near_multiplet = 1e-3;

// Displacements that are quadratic polynomials of the place, the smoothest there are; random ones where more are
// wanted.
MatrixXd start_vectors(const BodySystem& system, Index wanted) {
  const auto points = system.node_points();
  const Eigen::RowVector3d low = points.colwise().minCoeff(), size = points.colwise().maxCoeff() - low;
  constexpr Index fields = 10; // 1, x, y, z and their products
  MatrixXd start(3 * points.rows(), std::max(3 * fields, wanted));
  start.setZero();
  for (Index i = 0; i < points.rows(); ++i) {
    const Eigen::RowVector3d x = 2 * (points.row(i) - low).cwiseQuotient(size) - Eigen::RowVector3d::Ones();
    const double value[fields]{1,           x[0],        x[1],        x[2],        x[0] * x[0],
                               x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0]};
    for (Index f = 0; f < fields; ++f)
      for (Index d = 0; d < 3; ++d) start(3 * i + d, 3 * f + d) = value[f];
  }
  std::mt19937_64 random(1);
  for (Index c = 3 * fields; c < start.cols(); ++c)
    for (double& x : start.col(c)) x = std::uniform_real_distribution(-1.0, 1.0)(random);
  return start;
}

VectorXd residuals(const EigenProblem& problem, const MatrixXd& X, const VectorXd& lambda, double first_elastic) {
  const MatrixXd KX = columns_of(*problem.stiffness, X), MX = columns_of(*problem.mass, X);
  VectorXd all(X.cols());
  for (Index k = 0; k < X.cols(); ++k)
    all[k] = (KX.col(k) - lambda[k] * MX.col(k)).norm() / (std::max(lambda[k], first_elastic) * MX.col(k).norm());
  return all;
}

} // namespace

ModeSet multigrid_modes(const EigenProblem& problem, const EigenSettings& settings, const BodySystem& system,
                        std::span<const std::vector<std::int64_t>> held, SolverReport& report) {
  ModeSet set;
  Stopwatch watch(set.timings);
  const FreeMotions free =
      free_motions(*problem.stiffness, *problem.mass, problem.constraints, problem.motions, problem.lambda_scale);
  watch.stage("rigid modes");
  show_stage(problem.progress, "coarse grids");
  const Multigrid multigrid({problem.stiffness, problem.mass, -shift_share * problem.lambda_scale}, system, {}, held);
  report.level_nodes = multigrid.level_nodes();
  set.factor.bytes = multigrid.bytes();
  watch.stage("coarse grids");

  LobpcgProblem lowest;
  lowest.size = problem.mass->size();
  lowest.K = [&](const double* x, double* y, int columns) {
    for (int c = 0; c < columns; ++c) problem.stiffness->multiply(x + c * lowest.size, y + c * lowest.size);
  };
  lowest.M = [&](const double* x, double* y, int columns) { problem.mass->multiply(x, y, columns); };
  lowest.precondition = [&](const double* r, double* z, int columns) { multigrid.apply(r, z, columns); };
  lowest.locked = &free.vectors;
  lowest.M_locked = &free.mass_vectors;
  if (problem.progress) {
    problem.progress->start("iterations");
    lowest.progress = [&](int converged, int all) { problem.progress->update(converged, all); };
  }
  const int block = settings.modes + std::max(4, settings.modes / 3);
  const LobpcgResult found = lobpcg(lowest, start_vectors(system, block),
                                    {.wanted = settings.modes, .block = block, .tolerance = multigrid_residual});
  set.solves = found.applied;
  report.steps = found.steps;
  watch.stage("LOBPCG");
  if (!found.converged)
    throw NumericalError(fmt::format("LOBPCG did not converge to {} modes in {} steps: the largest residual is {:.2g}, "
                                     "expected {:g}; use solver = \"direct\"",
                                     settings.modes, found.steps, found.residual.head(settings.modes).maxCoeff(),
                                     multigrid_residual));
  if (found.lambda[0] < mechanism_guess * problem.lambda_scale)
    throw NumericalError("motions beside the rigid ones have no stiffness: parts of the model are connected by too "
                         "little material; solver = \"direct\" shows them");

  const Index rigid = free.vectors.cols(), elastic = settings.modes;
  set.rigid = rigid;
  set.elastic = elastic;
  set.lambda.resize(rigid + elastic);
  set.lambda << free.lambda, found.lambda.head(elastic);
  set.kind.assign(static_cast<std::size_t>(rigid), ModeKind::Rigid);
  set.kind.resize(static_cast<std::size_t>(rigid + elastic), ModeKind::Elastic);
  set.vectors.resize(found.vectors.rows(), rigid + elastic);
  if (rigid > 0) set.vectors.leftCols(rigid) = free.vectors;
  set.vectors.rightCols(elastic) = found.vectors.leftCols(elastic);
  set.residual = residuals(problem, set.vectors, set.lambda, found.lambda[0]);
  for (Index k = 0; k < set.vectors.cols(); ++k) orient(set.vectors.col(k));
  const double last = found.lambda[elastic - 1];
  if (found.lambda.size() > elastic && found.lambda[elastic] - last < near_multiplet * last)
    set.warnings.push_back(fmt::format("the last mode may belong to a multiplet; --modes {} shows it", elastic + 2));
  watch.stage("residuals");
  return set;
}

} // namespace iga::solve
