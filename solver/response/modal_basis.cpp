#include "solver/response/modal_basis.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/shift_invert.hpp"
#include "solver/base/dense_algebra.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the load; a load of which the modes leave no more has no residual vector.
constexpr double nothing_left = 1e-11;
constexpr double largest_defect = 1e-8;
// Eigenvalue of the Gram matrix of unit vectors below which one of them is a combination of the others to rounding.
constexpr double dependent = 1e-9;

// F less what the basis takes of it: F - M V Vᵀ F.
MatrixXd left_over(const MatrixXd& F, const MatrixXd& V, const MatrixXd& MV) {
  MatrixXd rest = F - MV * (V.transpose() * F);
  rest -= MV * (V.transpose() * rest);
  return rest;
}

// K R = F in the complement of the modes: the shift is small against their complement's stiffness, so that each round
// gains many digits.
MatrixXd static_solutions(const EigenProblem& problem, const MatrixXd& F, const MatrixXd& V, const MatrixXd& MV,
                          double shift) {
  constexpr int most_rounds = 30;
  const ShiftInvert inverse(problem, shift);
  MatrixXd R = MatrixXd::Zero(F.rows(), F.cols()), step(F.rows(), F.cols());
  VectorXd best = VectorXd::Constant(F.cols(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < most_rounds; ++round) {
    const MatrixXd rest = left_over(F - columns_of(*problem.stiffness, R), V, MV);
    const VectorXd size = rest.colwise().norm().cwiseQuotient(F.colwise().norm()).transpose();
    const bool gains = (size.array() < 0.5 * best.array()).any();
    best = best.cwiseMin(size);
    if (!gains || size.maxCoeff() < 1e-14) break;
    inverse.apply(rest.data(), step.data(), static_cast<int>(F.cols()));
    R += step - V * (MV.transpose() * step);
  }
  if (best.maxCoeff() > largest_defect)
    throw NumericalError(fmt::format("residual vectors: a static solution leaves {:.2g} of its load, expected below "
                                     "{:.0e}; residual_vectors = false in [response] goes without them",
                                     best.maxCoeff(), largest_defect));
  return R;
}

} // namespace

double ModalBasis::highest_frequency() const {
  return elastic > 0 ? omega(modes() - 1) / (2 * std::numbers::pi) : 0;
}

ModalBasis modal_basis(const ModeSet& modes) {
  if (modes.mechanisms > 0)
    throw NumericalError(fmt::format("{} motions without stiffness that are no rigid ones were found: parts that are "
                                     "connected by too little material; use smaller spans",
                                     modes.mechanisms));
  ModalBasis basis;
  basis.vectors = modes.vectors;
  basis.rigid = modes.rigid;
  basis.elastic = modes.elastic;
  basis.lambda = modes.lambda;
  basis.lambda.head(basis.rigid).setZero();
  return basis;
}

void add_residual_vectors(const EigenProblem& problem, const MatrixXd& loads, ModalBasis& basis, VectorXd& share) {
  const MatrixXd V = basis.vectors, MV = columns_of(*problem.mass, V);
  share = VectorXd::Ones(loads.cols());
  const MatrixXd all = left_over(loads, V, MV);
  std::vector<Index> kept;
  for (Index k = 0; k < loads.cols(); ++k)
    if (all.col(k).norm() > nothing_left * loads.col(k).norm()) kept.push_back(k);
  if (kept.empty()) return;
  const MatrixXd F = all(Eigen::all, kept);
  const double first = basis.elastic > 0 ? basis.lambda[basis.rigid] : problem.lambda_scale;
  MatrixXd R = static_solutions(problem, F, V, MV, -1e-3 * first);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const VectorXd p = V.rightCols(basis.elastic).transpose() * loads.col(kept[i]);
    const double modal = p.cwiseAbs2().cwiseQuotient(basis.lambda.segment(basis.rigid, basis.elastic)).sum();
    const double rest = std::max(0.0, R.col(static_cast<Index>(i)).dot(F.col(static_cast<Index>(i))));
    share[kept[i]] = modal + rest > 0 ? modal / (modal + rest) : 1;
  }

  R -= V * (MV.transpose() * R);
  MatrixXd MR = columns_of(*problem.mass, R);
  const VectorXd length = R.cwiseProduct(MR).colwise().sum().cwiseSqrt().transpose();
  R = R * length.cwiseInverse().asDiagonal();
  MR = MR * length.cwiseInverse().asDiagonal();
  const MatrixXd gram = R.transpose() * MR;
  const SymmetricEigen independent = symmetric_eigen(0.5 * (gram + gram.transpose()));
  const Index rank = (independent.values.array() > dependent).count();
  R = (R * independent.vectors.rightCols(rank) * independent.values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal())
          .eval();
  const MatrixXd stiffness = R.transpose() * columns_of(*problem.stiffness, R);
  const SymmetricEigen ritz = symmetric_eigen(0.5 * (stiffness + stiffness.transpose()));
  basis.residual = rank;
  basis.vectors.conservativeResize(Eigen::NoChange, basis.modes() + rank);
  basis.vectors.rightCols(rank) = R * ritz.vectors;
  basis.lambda.conservativeResize(basis.modes() + rank);
  basis.lambda.tail(rank) = ritz.values;
}

ModalDamping modal_damping(const DampingSettings& settings, const ModalBasis& basis) {
  ModalDamping damping{VectorXd::Zero(basis.size()), settings.structural};
  for (Index j = 0; j < basis.size(); ++j) {
    const double omega = basis.omega(j);
    double ratio = settings.ratio;
    if (settings.table) ratio = settings.table->linear(omega / (2 * std::numbers::pi));
    if (!settings.mode_ratios.empty()) {
      const auto mode = static_cast<std::size_t>(std::max<Index>(0, j - basis.rigid));
      ratio = settings.mode_ratios[std::min(mode, settings.mode_ratios.size() - 1)];
    }
    damping.c[j] = 2 * ratio * omega + settings.alpha + settings.beta * basis.lambda[j];
  }
  return damping;
}

double damping_ratio(const ModalDamping& damping, const ModalBasis& basis, Index j) {
  const double omega = basis.omega(j);
  return (omega > 0 ? damping.c[j] / (2 * omega) : 0) + damping.structural / 2;
}

} // namespace iga::solve
