#include "solver/multigrid/lobpcg.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/in_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index rows_at_once = 4096;
// Directions whose length in M is this share of the longest one's are rounding.
constexpr double dependent = 1e-12;

// Aᵀ B of tall matrices: fixed pieces, added in order.
MatrixXd tall_product(const MatrixXd& A, const MatrixXd& B) {
  MatrixXd sum = MatrixXd::Zero(A.cols(), B.cols());
  const Index n = A.rows(), pieces = (n + rows_at_once - 1) / rows_at_once;
  in_order(
      static_cast<std::size_t>(pieces),
      [&](std::size_t k) -> MatrixXd {
        const Index first = static_cast<Index>(k) * rows_at_once, count = std::min(rows_at_once, n - first);
        return A.middleRows(first, count).transpose() * B.middleRows(first, count);
      },
      [&](std::size_t, const MatrixXd& piece) { sum += piece; });
  return sum;
}

// B = A C, or B += A C, of a tall A and a small C.
void tall_times(const MatrixXd& A, const MatrixXd& C, bool add, MatrixXd& B) {
  if (!add) B.resize(A.rows(), C.cols());
  tbb::parallel_for(
      tbb::blocked_range<Index>(0, A.rows(), rows_at_once),
      [&](const tbb::blocked_range<Index>& range) {
        for (Index first = range.begin(); first < range.end(); first += rows_at_once) {
          const Index count = std::min(rows_at_once, range.end() - first);
          if (add)
            B.middleRows(first, count) += A.middleRows(first, count) * C;
          else
            B.middleRows(first, count).noalias() = A.middleRows(first, count) * C;
        }
      },
      tbb::simple_partitioner());
}

MatrixXd times(const MatrixXd& A, const MatrixXd& C) {
  MatrixXd B;
  tall_times(A, C, false, B);
  return B;
}

MatrixXd side_by_side(std::initializer_list<const MatrixXd*> parts) {
  Index rows = 0, columns = 0;
  for (const MatrixXd* part : parts) {
    rows = std::max(rows, part->rows());
    columns += part->cols();
  }
  MatrixXd all(rows, columns);
  Index at = 0;
  for (const MatrixXd* part : parts) {
    if (part->cols() > 0) all.middleCols(at, part->cols()) = *part;
    at += part->cols();
  }
  return all;
}

// C such that A C is orthonormal, from the products G = Aᵀ M A; dependent columns are dropped. Stathopoulos and Wu
// (2002).
MatrixXd orthonormalising(const MatrixXd& G) {
  const VectorXd d = G.diagonal().unaryExpr([](double g) { return g > 0 ? 1 / std::sqrt(g) : 0.0; });
  const SymmetricEigen eigen = symmetric_eigen(d.asDiagonal() * (0.5 * (G + G.transpose())) * d.asDiagonal());
  const double largest = eigen.values.size() > 0 ? eigen.values[eigen.values.size() - 1] : 0;
  Index first = 0;
  while (first < eigen.values.size() && !(eigen.values[first] > dependent * largest)) ++first;
  const Index kept = eigen.values.size() - first;
  return d.asDiagonal() * eigen.vectors.rightCols(kept) *
         eigen.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Vectors with their products.
struct Block {
  MatrixXd V, KV, MV;
  Index cols() const { return V.cols(); }
};

class Iteration {
 public:
  Iteration(const LobpcgProblem& problem, const LobpcgSettings& settings) : problem_(problem), settings_(settings) {}

  LobpcgResult run(const MatrixXd& start) {
    begin(start);
    for (;;) {
      const MatrixXd R = defects();
      const Index converged = (result_.residual.head(wanted()).array() <= settings_.tolerance).count();
      if (problem_.progress) problem_.progress(static_cast<int>(converged), static_cast<int>(wanted()));
      result_.converged = converged == wanted();
      if (result_.converged || result_.steps == settings_.most_steps || !result_.residual.allFinite()) break;
      io::stop_if_interrupted();
      ++result_.steps;
      if (!step(R)) break;
    }
    result_.lambda = lambda_;
    result_.vectors = std::move(x_.V);
    return std::move(result_);
  }

 private:
  Index wanted() const { return std::min<Index>(settings_.wanted, x_.cols()); }

  MatrixXd apply(const BlockOperator& A, const MatrixXd& X) const {
    MatrixXd Y(X.rows(), X.cols());
    A(X.data(), Y.data(), static_cast<int>(X.cols()));
    return Y;
  }

  // What W has in the directions of the locked vectors is taken out.
  void unlock(MatrixXd& W) const {
    if (!problem_.locked || problem_.locked->cols() == 0) return;
    tall_times(*problem_.locked, -tall_product(*problem_.M_locked, W), true, W);
  }

  void begin(const MatrixXd& start) {
    x_.V = start;
    for (int pass = 0; pass < 2; ++pass) {
      unlock(x_.V);
      x_.MV = apply(problem_.M, x_.V);
      x_.V = times(x_.V, orthonormalising(tall_product(x_.V, x_.MV)));
    }
    x_.MV = apply(problem_.M, x_.V);
    x_.KV = apply(problem_.K, x_.V);
    rotate(Block{x_}, symmetric_eigen_of(tall_product(x_.V, x_.KV)), x_); // the lowest ones alone
  }

  MatrixXd symmetric_eigen_of(const MatrixXd& H) {
    const SymmetricEigen eigen = symmetric_eigen(0.5 * (H + H.transpose()));
    const Index count = std::min<Index>(settings_.block, H.cols());
    lambda_ = eigen.values.head(count);
    return eigen.vectors.leftCols(count);
  }

  static void rotate(const Block& S, const MatrixXd& C, Block& target) {
    target.V = times(S.V, C);
    target.KV = times(S.KV, C);
    target.MV = times(S.MV, C);
  }

  // K X - M X Λ; residuals of all columns.
  MatrixXd defects() {
    MatrixXd R = x_.KV;
    result_.residual.resize(x_.cols());
    tbb::parallel_for(Index{0}, x_.cols(), [&](Index k) {
      R.col(k) -= lambda_[k] * x_.MV.col(k);
      result_.residual[k] = R.col(k).norm() / (std::abs(lambda_[k]) * x_.MV.col(k).norm());
    });
    return R;
  }

  // New directions for what has not converged, orthonormal to X, P and the locked vectors.
  Block directions(const MatrixXd& R) {
    std::vector<Index> active;
    for (Index k = 0; k < x_.cols(); ++k)
      if (result_.residual[k] > settings_.tolerance) active.push_back(k);
    MatrixXd open(R.rows(), static_cast<Index>(active.size()));
    for (std::size_t k = 0; k < active.size(); ++k) open.col(static_cast<Index>(k)) = R.col(active[k]);
    Block w;
    w.V = apply(problem_.precondition, open);
    result_.applied += open.cols();
    const MatrixXd basis = side_by_side({&x_.V, &p_.V}), M_basis = side_by_side({&x_.MV, &p_.MV});
    for (int pass = 0; pass < 2; ++pass) { // twice is enough
      unlock(w.V);
      tall_times(basis, -tall_product(M_basis, w.V), true, w.V);
      w.MV = apply(problem_.M, w.V);
      const MatrixXd C = orthonormalising(tall_product(w.V, w.MV));
      w.V = times(w.V, C);
      if (pass == 1) w.MV = times(w.MV, C);
    }
    w.KV = apply(problem_.K, w.V);
    return w;
  }

  bool step(const MatrixXd& R) {
    const Index m = x_.cols();
    Block w = directions(R);
    if (w.cols() == 0) return false;
    const Block S{side_by_side({&x_.V, &w.V, &p_.V}), side_by_side({&x_.KV, &w.KV, &p_.KV}),
                  side_by_side({&x_.MV, &w.MV, &p_.MV})};
    w = {};
    const MatrixXd C = symmetric_eigen_of(tall_product(S.V, S.KV));
    // The part of the new X that lies beyond the old one, orthonormal to the new one.
    MatrixXd Z = C;
    Z.topRows(m).setZero();
    for (int pass = 0; pass < 2; ++pass) {
      Z -= C * (C.transpose() * Z);
      Z = (Z * orthonormalising(Z.transpose() * Z)).eval();
    }
    rotate(S, C, x_);
    rotate(S, Z, p_);
    return true;
  }

  const LobpcgProblem& problem_;
  const LobpcgSettings& settings_;
  LobpcgResult result_;
  Block x_, p_;
  VectorXd lambda_;
};

} // namespace

LobpcgResult lobpcg(const LobpcgProblem& problem, const MatrixXd& start, const LobpcgSettings& settings) {
  return Iteration(problem, settings).run(start);
}

} // namespace iga::solve
