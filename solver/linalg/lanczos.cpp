#include "solver/linalg/lanczos.hpp"

#include "format/io/interrupt.hpp"
#include "solver/base/dense_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A vector that keeps less than this of its length when others are taken out is nothing but rounding.
constexpr double vanished = 1e-13;

class Basis {
 public:
  Basis(const LanczosProblem& problem, const LanczosSettings& settings)
      : problem_(problem), n_(problem.size), dimensions_(problem.size - (problem.locked ? problem.locked->cols() : 0)),
        block_(std::clamp<Index>(settings.block, 1, std::max<Index>(1, dimensions_))), random_(settings.seed) {
    const Index held = settings.max_basis > 0
                           ? settings.max_basis
                           : std::max<Index>(2 * Index{settings.wanted} + 8 * block_, settings.wanted + 60);
    capacity_ = std::min(std::max(held, settings.wanted + 2 * block_), dimensions_);
    V_.resize(n_, capacity_ + block_);
    BV_.resize(n_, capacity_ + block_);
    H_ = MatrixXd::Zero(capacity_ + block_, capacity_ + block_);
  }

  Index capacity() const { return capacity_; }
  Index dimensions() const { return dimensions_; }
  Index block() const { return block_; }

  /// The first block, one operator step away from random vectors.
  void start() {
    MatrixXd W(n_, block_), BW(n_, block_);
    for (Index c = 0; c < block_; ++c) W.col(c) = random_vector();
    problem_.B(W.data(), BW.data(), static_cast<int>(block_));
    MatrixXd FBW(n_, block_);
    apply(W.data(), BW.data(), FBW.data(), block_);
    first_ = end_ = 0;
    append(FBW, Eigen::VectorXd::Zero(block_));
    end_ = new_end_;
  }

  /// Applies the operator to the newest block; false where the space is exhausted.
  bool step() {
    const Index b = end_ - first_;
    MatrixXd W(n_, b);
    apply(V_.col(first_).data(), BV_.col(first_).data(), W.data(), b);
    applied_ += b;
    MatrixXd h = MatrixXd::Zero(end_, b);
    for (int pass = 0; pass < 2; ++pass) {
      remove_locked(W);
      const MatrixXd part = BV_.leftCols(end_).transpose() * W;
      W.noalias() -= V_.leftCols(end_) * part;
      h += part;
    }
    H_.block(0, first_, end_, b) = h;
    H_.block(first_, 0, b, end_) = h.transpose();
    const MatrixXd own = H_.block(first_, first_, b, b);
    H_.block(first_, first_, b, b) = 0.5 * (own + own.transpose());
    append(W, h.colwise().norm());
    return new_end_ > end_;
  }

  /// Ritz pairs of all vectors the operator was applied to, best first.
  void ritz() {
    const SymmetricEigen eigen = symmetric_eigen(H_.topLeftCorner(end_, end_));
    theta_ = eigen.values.reverse();
    S_ = eigen.vectors.rowwise().reverse();
    estimate_ = (R_ * S_.bottomRows(end_ - first_)).colwise().norm();
  }
  const Eigen::VectorXd& theta() const { return theta_; }
  const Eigen::VectorXd& estimate() const { return estimate_; }
  Index size() const { return end_; }
  Index size_with_next() const { return new_end_; }
  std::int64_t applied() const { return applied_; }

  /// Takes the new block into the basis.
  void advance() {
    first_ = end_;
    end_ = new_end_;
  }

  /// Keeps the `kept` best Ritz vectors and the new block.
  void restart(Index kept) {
    const Index b = new_end_ - end_;
    MatrixXd X = V_.leftCols(end_) * S_.leftCols(kept);
    V_.leftCols(kept) = X;
    X.noalias() = BV_.leftCols(end_) * S_.leftCols(kept);
    BV_.leftCols(kept) = X;
    const MatrixXd next = V_.middleCols(end_, b), B_next = BV_.middleCols(end_, b);
    V_.middleCols(kept, b) = next;
    BV_.middleCols(kept, b) = B_next;
    H_.setZero();
    H_.topLeftCorner(kept, kept).diagonal() = theta_.head(kept);
    first_ = kept;
    end_ = kept + b;
  }

  /// F B X / θ for the `count` best Ritz vectors X, free of charge: X + V_next R S_last / θ.
  MatrixXd vectors(Index count) const {
    MatrixXd X = V_.leftCols(end_) * S_.leftCols(count);
    const Index b = new_end_ - end_;
    if (b > 0) {
      const MatrixXd rest =
          R_.topRows(b) * S_.block(first_, 0, end_ - first_, count) * theta_.head(count).cwiseInverse().asDiagonal();
      X.noalias() += V_.middleCols(end_, b) * rest;
    }
    for (Index c = 0; c < count; ++c) {
      Eigen::VectorXd BX(n_);
      problem_.B(X.col(c).data(), BX.data(), 1);
      X.col(c) /= std::sqrt(X.col(c).dot(BX));
    }
    return X;
  }

 private:
  // Y = F B X.
  void apply(const double* X, const double* BX, double* Y, Index columns) const {
    if (problem_.FB)
      problem_.FB(X, Y, static_cast<int>(columns));
    else
      problem_.F(BX, Y, static_cast<int>(columns));
  }

  Eigen::VectorXd random_vector() {
    Eigen::VectorXd x(n_);
    // Uniform in [-1, 1) from the generator's own bits: the same with every standard library.
    for (Index i = 0; i < n_; ++i) x[i] = std::ldexp(static_cast<double>(random_() >> 11), -52) - 1;
    if (problem_.start_scale.size() == n_) x.array() *= problem_.start_scale.array();
    return x;
  }

  void remove_locked(Eigen::Ref<MatrixXd> W) const {
    if (problem_.locked && problem_.locked->cols() > 0)
      W -= *problem_.locked * (problem_.B_locked->transpose() * W).eval();
  }

  // Makes W B-orthonormal behind the vectors up to end_: W = V_new R; `taken` are the lengths that were taken out of
  // its columns. A column that vanishes is replaced by a random one (R has zeros there) while the space has dimensions
  // left.
  void append(const MatrixXd& W, const Eigen::VectorXd& taken) {
    const Index b = W.cols();
    R_ = MatrixXd::Zero(block_, b);
    new_end_ = end_;
    for (Index c = 0; c < block_ && new_end_ < dimensions_; ++c) {
      Eigen::VectorXd w;
      if (c < b) {
        w = W.col(c);
        if (take(w, taken[c], &c)) continue;
      }
      for (int tries = 0; tries < 3; ++tries) {
        w = random_vector();
        if (take(w, 0, nullptr)) break;
      }
    }
  }

  // Takes what is left of w beside all others into the basis, unless nothing is; column of R where w is an image.
  bool take(Eigen::VectorXd& w, double taken, const Index* column) {
    Eigen::VectorXd Bw(n_);
    problem_.B(w.data(), Bw.data(), 1);
    const double before = std::hypot(taken, std::sqrt(std::max(0.0, w.dot(Bw))));
    if (!(before > 0)) return false;
    double length = 0;
    for (int pass = 0; pass < 2; ++pass) {
      remove_locked(w);
      const Eigen::VectorXd part = BV_.leftCols(new_end_).transpose() * w;
      w.noalias() -= V_.leftCols(new_end_) * part;
      if (column) R_.col(*column).head(new_end_ - end_) += part.tail(new_end_ - end_);
      problem_.B(w.data(), Bw.data(), 1);
      length = std::sqrt(std::max(0.0, w.dot(Bw)));
    }
    if (!(length > vanished * before)) return false;
    V_.col(new_end_) = w / length;
    BV_.col(new_end_) = Bw / length;
    if (column) R_(new_end_ - end_, *column) = length;
    ++new_end_;
    return true;
  }

  const LanczosProblem& problem_;
  Index n_, dimensions_, block_, capacity_ = 0;
  std::mt19937_64 random_;
  MatrixXd V_, BV_, H_, R_, S_;
  Eigen::VectorXd theta_, estimate_;
  Index first_ = 0, end_ = 0, new_end_ = 0; // newest block: first_ … end_; the next one: end_ … new_end_
  std::int64_t applied_ = 0;
};

} // namespace

LanczosResult block_lanczos(const LanczosProblem& problem, const LanczosSettings& settings) {
  LanczosResult result;
  Basis basis(problem, settings);
  const Index wanted = std::min<Index>(settings.wanted, basis.dimensions());
  if (wanted <= 0) {
    result.converged = true;
    result.vectors.resize(problem.size, 0);
    return result;
  }
  basis.start();
  for (int restarts = 0;;) {
    io::stop_if_interrupted();
    const bool more = basis.step();
    const bool full = basis.size_with_next() > basis.capacity();
    if (basis.size() >= wanted || !more || full) {
      basis.ritz();
      const Index count = std::min(wanted, basis.size());
      const auto good =
          basis.estimate().head(count).array() <= settings.tolerance * basis.theta().head(count).array().abs();
      result.converged = good.all();
      if (problem.progress) problem.progress(static_cast<int>(good.count()), static_cast<int>(wanted));
      if (result.converged || !more || (full && restarts >= settings.max_restarts)) {
        result.theta = basis.theta().head(count);
        result.estimate = basis.estimate().head(count);
        result.vectors = basis.vectors(count);
        result.applied = basis.applied();
        if (!more) result.converged = true;
        return result;
      }
      if (full) {
        ++restarts;
        basis.restart(std::min(basis.size(), wanted + std::max(basis.block(), (basis.capacity() - wanted) / 3)));
        continue;
      }
    }
    basis.advance();
  }
}

} // namespace iga::solve
