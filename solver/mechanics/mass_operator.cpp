#include "solver/mechanics/mass_operator.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/lanczos.hpp"
#include "solver/mechanics/assemble.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

using Eigen::VectorXd;

VectorXd per_unknown(const VectorXd& nodes) {
  VectorXd all(3 * nodes.size());
  for (Eigen::Index i = 0; i < nodes.size(); ++i) all.segment<3>(3 * i).setConstant(nodes[i]);
  return all;
}

void require_positive(const VectorXd& masses) {
  Eigen::Index worst = 0;
  const double least = masses.minCoeff(&worst);
  if (!(least >= 0))
    throw NumericalError(
        fmt::format("the lumped mass of function {} is {:.3g}: the extension of light functions takes more mass from "
                    "it than it has; "
                    "lower --light-threshold, use --light-functions linear or none, or --mass consistent",
                    worst, least));
}

} // namespace

MassOperator MassOperator::consistent(MassMatrix M) {
  MassOperator op;
  op.size_ = M.size();
  op.total_ = M.row_sums().sum();
  if (M.low_rank().rows() > 0) {
    const VectorXd along_x = Eigen::Vector3d::UnitX().replicate(M.pattern().num_nodes(), 1);
    op.total_ += (M.low_rank() * along_x).squaredNorm();
  }
  op.matrix_ = std::move(M);
  return op;
}

MassOperator MassOperator::lumped(VectorXd masses, std::int64_t moved_functions) {
  require_positive(masses);
  MassOperator op;
  op.moved_ = moved_functions;
  op.size_ = 3 * masses.size();
  op.total_ = masses.sum();
  op.root_ = per_unknown(masses.cwiseSqrt());
  op.inverse_ = op.root_.unaryExpr([](double r) { return r > 0 ? 1 / r : 0.0; });
  op.masses_ = std::move(masses);
  return op;
}

MassOperator MassOperator::multi_pass(MassMatrix M, int passes) {
  MassOperator op = lumped(M.row_sums());
  op.passes_ = passes;
  op.matrix_ = std::move(M);
  return op;
}

VectorXd MassOperator::inverse_root_scale() const {
  if (!is_consistent()) return inverse_;
  return per_unknown(matrix_->diagonal().unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 0.0; }));
}

// y = S x with S = I + R (+ R²), R = I - M_L^(-1/2) M_C M_L^(-1/2): the series in scaled unknowns, in Horner's form.
void MassOperator::series(const VectorXd& x, VectorXd& y) const {
  VectorXd work(size_), Mw(size_);
  y = x;
  for (int pass = 1; pass < passes_; ++pass) {
    work = inverse_.cwiseProduct(y);
    matrix_->multiply(work.data(), Mw.data());
    y += x - inverse_.cwiseProduct(Mw);
  }
}

// M x = M_L^(1/2) S⁻¹ M_L^(1/2) x by conjugate gradients. S has its spectrum in [1, passes] for the plain basis, where
// each step gains a factor of four or more; with an extension it may come closer to zero and takes more steps.
void MassOperator::multiply_series_inverse(const double* x, double* y) const {
  constexpr int most_steps = 500;
  const VectorXd b = root_.cwiseProduct(Eigen::Map<const VectorXd>(x, size_));
  VectorXd z = b / (0.5 * (1 + passes_)), Sz(size_), r, p, Sp(size_);
  series(z, Sz);
  r = b - Sz;
  p = r;
  double rr = r.squaredNorm();
  const double small = std::pow(4 * std::numeric_limits<double>::epsilon(), 2) * b.squaredNorm();
  int step = 0;
  for (; step < most_steps && rr > small; ++step) {
    series(p, Sp);
    const double curvature = p.dot(Sp);
    if (!(curvature > 0))
      throw NumericalError("the multi-pass mass is not positive definite with this extension of light functions; lower "
                           "--light-threshold or use --mass three-pass or lumped");
    const double alpha = rr / curvature;
    z += alpha * p;
    r -= alpha * Sp;
    const double next = r.squaredNorm();
    p = r + (next / rr) * p;
    rr = next;
  }
  Eigen::Map<VectorXd>(y, size_) = root_.cwiseProduct(z);
}

void MassOperator::multiply(const double* x, double* y, int columns) const {
  for (int c = 0; c < columns; ++c, x += size_, y += size_) {
    if (is_consistent())
      matrix_->multiply(x, y);
    else if (is_lumped())
      Eigen::Map<VectorXd>(y, size_) = root_.cwiseAbs2().cwiseProduct(Eigen::Map<const VectorXd>(x, size_));
    else
      multiply_series_inverse(x, y);
  }
}

VectorXd MassOperator::operator*(const VectorXd& x) const {
  VectorXd y(size_);
  multiply(x.data(), y.data(), 1);
  return y;
}

// (M₀ + Wᵀ W)⁻¹ by Woodbury's formula.
void MassOperator::divide(const double* x, double* y, int columns) const {
  divide_pattern(x, y, columns);
  if (!has_low_rank()) return;
  const RowMatrix& W = matrix_->low_rank();
  if (solved_.cols() == 0) {
    const Eigen::MatrixXd right = Eigen::MatrixXd(W).transpose();
    solved_.resize(right.rows(), right.cols());
    divide_pattern(right.data(), solved_.data(), static_cast<int>(right.cols()));
    capacity_ = (Eigen::MatrixXd::Identity(W.rows(), W.rows()) + W * solved_).inverse();
  }
  Eigen::Map<Eigen::MatrixXd> Y(y, size_, columns);
  const Eigen::MatrixXd along = W * Y;
  Y.noalias() -= solved_ * (capacity_ * along);
}

void MassOperator::divide_pattern(const double* x, double* y, int columns) const {
  if (is_consistent()) {
    if (!factor_) factor_ = factorise_mass(*matrix_);
    const Eigen::Index n = size_ / 3;
    // Component by component: a mass matrix acts on each of them alike.
    Eigen::MatrixXd b(n, 3 * columns), solution(n, 3 * columns);
    for (Eigen::Index c = 0; c < 3 * columns; ++c)
      b.col(c) = Eigen::Map<const VectorXd, 0, Eigen::InnerStride<3>>(x + (c / 3) * size_ + c % 3, n);
    factor_->solve(b.data(), solution.data(), 3 * columns);
    for (Eigen::Index c = 0; c < 3 * columns; ++c)
      Eigen::Map<VectorXd, 0, Eigen::InnerStride<3>>(y + (c / 3) * size_ + c % 3, n) = solution.col(c);
    return;
  }
  VectorXd z(size_);
  for (int c = 0; c < columns; ++c, x += size_, y += size_) {
    const VectorXd scaled = inverse_.cwiseProduct(Eigen::Map<const VectorXd>(x, size_));
    series(scaled, z);
    Eigen::Map<VectorXd>(y, size_) = inverse_.cwiseProduct(z);
  }
}

Eigen::MatrixXd columns_of(const StiffnessMatrix& K, const Eigen::MatrixXd& X) {
  Eigen::MatrixXd Y(X.rows(), X.cols());
  for (Eigen::Index c = 0; c < X.cols(); ++c) K.multiply(X.col(c).data(), Y.col(c).data());
  return Y;
}

Eigen::MatrixXd columns_of(const MassOperator& M, const Eigen::MatrixXd& X) {
  Eigen::MatrixXd Y(X.rows(), X.cols());
  M.multiply(X.data(), Y.data(), static_cast<int>(X.cols()));
  return Y;
}

double largest_mass_ratio(const MassMatrix& M, const VectorXd& masses) {
  const VectorXd inverse = per_unknown(masses.unaryExpr([](double m) { return m > 0 ? 1 / m : 0.0; }));
  LanczosProblem problem;
  problem.size = M.size();
  problem.F = [&](const double* x, double* y, int columns) {
    for (int c = 0; c < columns; ++c) M.multiply(x + c * M.size(), y + c * M.size());
  };
  problem.B = [&](const double* x, double* y, int columns) {
    for (int c = 0; c < columns; ++c)
      Eigen::Map<VectorXd>(y + c * M.size(), M.size()) =
          inverse.cwiseProduct(Eigen::Map<const VectorXd>(x + c * M.size(), M.size()));
  };
  problem.start_scale = per_unknown(masses.cwiseSqrt());
  const LanczosResult found = block_lanczos(problem, {.wanted = 1, .block = 1, .max_basis = 80, .tolerance = 1e-3});
  return found.theta.size() > 0 ? found.theta[0] : 0;
}

SparedMasses spare_masses(const SolutionSpace& space, double density) {
  constexpr double kept = 0.2; // of a node's own mass; less than this would let its frequency grow beyond bounds
  SparedMasses spared;
  spared.masses = lumped_mass(space, density);
  if (!space.is_extended()) return spared;
  const VectorXd own = lumped_mass(SolutionSpace(space.model(), {}), density); // of every unknown of the model
  const auto& E = space.unknown_extension();
  const auto nodes = space.node_unknowns();
  using Entry = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  std::vector<bool> moved(static_cast<std::size_t>(E.rows()), false);
  // Each round moves at least one function; masses of nodes nothing is taken from any more are at least their own.
  for (bool again = true; again;) {
    again = false;
    std::vector<bool> poor(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      poor[i] = spared.masses[static_cast<Eigen::Index>(i)] <= kept * own[nodes[i]];
    for (Eigen::Index f = 0; f < E.rows(); ++f) {
      if (moved[static_cast<std::size_t>(f)]) continue;
      bool takes = false;
      for (Entry it(E, f); it; ++it) takes = takes || (it.value() < 0 && poor[static_cast<std::size_t>(it.col())]);
      if (!takes) continue;
      Eigen::Index nearest = 0;
      double most = 0;
      for (Entry it(E, f); it; ++it) {
        spared.masses[it.col()] -= it.value() * own[f];
        if (it.value() > most) {
          most = it.value();
          nearest = it.col();
        }
      }
      spared.masses[nearest] += own[f];
      moved[static_cast<std::size_t>(f)] = again = true;
      ++spared.moved;
    }
  }
  return spared;
}

namespace {

SparedMasses spare_masses(const BodySystem& system) {
  SparedMasses all;
  all.masses.resize(system.num_nodes());
  for (const SystemBody& body : system) {
    const SparedMasses spared = spare_masses(*body.space, body.material.density);
    all.masses.segment(body.first_node, spared.masses.size()) = spared.masses;
    all.moved += spared.moved;
  }
  return all;
}

} // namespace

MassOperator make_mass(MassType type, const SolutionSpace& space,
                       const std::shared_ptr<const Connectivity>& connectivity, double density) {
  ElasticMaterial material;
  material.density = density;
  return make_mass(type, BodySystem(space, material), connectivity);
}

MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       const AddedMassTerms& added) {
  assert(added.rows.empty() || type == MassType::Consistent);
  if (type == MassType::Lumped) {
    SparedMasses spared = spare_masses(system);
    if (added.lumped.size() > 0) spared.masses += added.lumped;
    return MassOperator::lumped(std::move(spared.masses), spared.moved);
  }
  MassMatrix M = assemble_mass(system, connectivity);
  for (const AddedMassTerms::Block& block : added.blocks) M.add(block.nodes, block.matrix, block.first_node);
  for (const RowMatrix& rows : added.rows) M.add_low_rank(rows);
  if (type == MassType::Consistent) return MassOperator::consistent(std::move(M));
  MassOperator mass = MassOperator::multi_pass(std::move(M), type == MassType::TwoPass ? 2 : 3);
  const bool extended = std::any_of(system.begin(), system.end(), [](const auto& b) { return b.space->is_extended(); });
  if (type == MassType::TwoPass && extended) {
    // Lanczos comes from below; 1 % is ten times its tolerance.
    const double ratio = 1.01 * largest_mass_ratio(*mass.matrix(), *mass.masses());
    if (ratio >= 2)
      throw InputError(
          fmt::format("the two-pass mass is not positive definite here: the largest eigenvalue of the "
                      "consistent mass over the lumped one is {:.3g}, at most 2 is allowed; lower "
                      "--light-threshold (now {:g}; 0.01 has proved safe), or use --mass three-pass or lumped",
                      ratio, system[0].space->treatment().threshold));
  }
  return mass;
}

} // namespace iga::solve
