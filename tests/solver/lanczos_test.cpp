// Block Lanczos against dense eigenvalues.
#include "solver/linalg/lanczos.hpp"

#include "format/io/interrupt.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstdlib>

using namespace iga::solve;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Pair {
  MatrixXd F, B;
  VectorXd theta; ///< eigenvalues of F B, ascending

  // Eigenvalues `theta` by construction: F = L⁻ᵀ Q Θ Qᵀ L⁻¹ for B = L Lᵀ.
  explicit Pair(const VectorXd& values) : theta(values) {
    const Eigen::Index n = values.size();
    MatrixXd A(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) A(i, j) = std::sin(1.0 + static_cast<double>(3 * i * i + 7 * j + i * j));
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(A).householderQ();
    MatrixXd L = MatrixXd::Identity(n, n);
    L.diagonal(-1).setConstant(0.3);
    const MatrixXd inverse = L.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(n, n));
    B = L * L.transpose();
    F = inverse.transpose() * Q * values.asDiagonal() * Q.transpose() * inverse;
  }
  LanczosProblem problem() const {
    LanczosProblem p;
    p.size = theta.size();
    const auto apply = [](const MatrixXd& A) {
      return [&A](const double* x, double* y, int columns) {
        Eigen::Map<MatrixXd>(y, A.rows(), columns) = A * Eigen::Map<const MatrixXd>(x, A.rows(), columns);
      };
    };
    p.F = apply(F);
    p.B = apply(B);
    return p;
  }
};

VectorXd spread(Eigen::Index n) {
  VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = 1.0 / (1.0 + static_cast<double>(n - 1 - i));
  return v;
}

void expect_largest(const Pair& pair, const LanczosResult& found, Eigen::Index wanted) {
  ASSERT_TRUE(found.converged);
  ASSERT_EQ(found.theta.size(), wanted);
  const Eigen::Index n = pair.theta.size();
  for (Eigen::Index k = 0; k < wanted; ++k)
    EXPECT_NEAR(found.theta[k], pair.theta[n - 1 - k], 1e-11 * pair.theta[n - 1]);
  const MatrixXd G = found.vectors.transpose() * pair.B * found.vectors;
  EXPECT_LT((G - MatrixXd::Identity(wanted, wanted)).cwiseAbs().maxCoeff(), 1e-8);
  const MatrixXd R = pair.F * pair.B * found.vectors - found.vectors * found.theta.asDiagonal();
  EXPECT_LT(R.cwiseAbs().maxCoeff(), 1e-8 * pair.theta[n - 1]);
}

} // namespace

TEST(Lanczos, FindsTheLargestWithAnyBlock) {
  const Pair pair(spread(200));
  for (const int block : {1, 2, 3, 5})
    expect_largest(pair, block_lanczos(pair.problem(), {.wanted = 7, .block = block}), 7);
}

TEST(Lanczos, FindsEveryCopyOfAMultipleEigenvalue) {
  VectorXd theta = spread(150);
  theta.tail(9) << 2, 2, 2, 3, 3, 3, 3, 3, 4;
  const Pair pair(theta);
  expect_largest(pair, block_lanczos(pair.problem(), {.wanted = 9, .block = 5}), 9);
}

TEST(Lanczos, RestartsInASmallBasis) {
  VectorXd theta(300);
  for (Eigen::Index i = 0; i < 300; ++i) theta[i] = 10 + 0.01 * static_cast<double>(i); // crowded: slow
  const Pair pair(theta);
  const LanczosResult found = block_lanczos(pair.problem(), {.wanted = 4, .block = 2, .max_basis = 20});
  EXPECT_GT(found.applied, 40);
  expect_largest(pair, found, 4);
}

TEST(Lanczos, KeepsClearOfLockedVectors) {
  const Pair pair(spread(80));
  const LanczosResult first = block_lanczos(pair.problem(), {.wanted = 3, .tolerance = 1e-12});
  const MatrixXd B_locked = pair.B * first.vectors;
  LanczosProblem problem = pair.problem();
  problem.locked = &first.vectors;
  problem.B_locked = &B_locked;
  const LanczosResult next = block_lanczos(problem, {.wanted = 2, .tolerance = 1e-12});
  EXPECT_NEAR(next.theta[0], pair.theta[76], 1e-12);
  EXPECT_NEAR(next.theta[1], pair.theta[75], 1e-12);
}

TEST(Lanczos, ASmallSpaceIsExhausted) {
  const Pair pair(spread(7));
  const LanczosResult found = block_lanczos(pair.problem(), {.wanted = 20, .block = 4});
  ASSERT_EQ(found.theta.size(), 7);
  EXPECT_TRUE(found.converged);
  for (Eigen::Index k = 0; k < 7; ++k) EXPECT_NEAR(found.theta[k], pair.theta[6 - k], 1e-12);
}

TEST(Lanczos, IsTheSameEveryTime) {
  const Pair pair(spread(90));
  const LanczosResult a = block_lanczos(pair.problem(), {.wanted = 5}),
                      b = block_lanczos(pair.problem(), {.wanted = 5});
  EXPECT_EQ(a.vectors, b.vectors);
  EXPECT_EQ(a.theta, b.theta);
}

// The first Ctrl-C only sets a flag: what runs long has to ask for it.
TEST(BlockLanczosDeathTest, StopsWhereASignalArrived) {
  const auto interrupted = [] {
    iga::io::install_signal_handlers();
    std::raise(SIGINT);
    try {
      const Pair pair(spread(30));
      block_lanczos(pair.problem(), {.wanted = 2});
    } catch (const iga::io::Interrupted&) {
      std::exit(iga::io::pending_signal());
    }
    std::exit(0);
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(SIGINT), "");
}
