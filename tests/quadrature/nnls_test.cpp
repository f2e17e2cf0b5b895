#include "preprocessor/base/nnls.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace iga::prep {
namespace {

using Matrix = Eigen::MatrixXd; // (m × n): one column a candidate
using Vector = Eigen::VectorXd;

// Lawson & Hanson (1974), chapter 23, as printed: a fresh least-squares problem in every step.
Vector reference_nnls(const Matrix& A, const Vector& b) {
  const Eigen::Index n = A.cols();
  Vector w = Vector::Zero(n);
  std::vector<bool> passive(static_cast<std::size_t>(n), false);
  const auto solve_passive = [&] {
    std::vector<Eigen::Index> set;
    for (Eigen::Index j = 0; j < n; ++j)
      if (passive[static_cast<std::size_t>(j)]) set.push_back(j);
    Vector z = Vector::Zero(n);
    if (!set.empty()) z(set) = Matrix(A(Eigen::all, set)).colPivHouseholderQr().solve(b);
    return z;
  };
  for (int step = 0; step < 20 * n; ++step) {
    const Vector g = A.transpose() * (b - A * w);
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < n; ++j)
      if (!passive[static_cast<std::size_t>(j)] && g[j] > 1e-11 * b.norm() && (best < 0 || g[j] > g[best])) best = j;
    if (best < 0) break;
    passive[static_cast<std::size_t>(best)] = true;
    Vector z = solve_passive();
    while (true) {
      double alpha = 1;
      bool feasible = true;
      for (Eigen::Index j = 0; j < n; ++j)
        if (passive[static_cast<std::size_t>(j)] && z[j] <= 0) {
          feasible = false;
          alpha = std::min(alpha, w[j] / (w[j] - z[j]));
        }
      if (feasible) break;
      w += alpha * (z - w);
      for (Eigen::Index j = 0; j < n; ++j)
        if (passive[static_cast<std::size_t>(j)] && w[j] <= 1e-14) {
          w[j] = 0;
          passive[static_cast<std::size_t>(j)] = false;
        }
      z = solve_passive();
    }
    w = z;
  }
  return w;
}

std::span<const double> data(const Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

void add(Nnls& nnls, const Matrix& A) { // column-major: one candidate after the other
  nnls.add_columns({A.data(), static_cast<std::size_t>(A.size())}, static_cast<std::size_t>(A.cols()));
}

Vector solution(const Nnls& nnls) {
  Vector w = Vector::Zero(static_cast<Eigen::Index>(nnls.num_columns()));
  for (std::size_t i = 0; i < nnls.num_passive(); ++i) w[static_cast<Eigen::Index>(nnls.passive(i))] += nnls.weight(i);
  return w;
}

void expect_optimal(const Nnls& nnls, const Matrix& A, const Vector& b) {
  const Vector w = solution(nnls), r = b - A * w;
  for (std::size_t i = 0; i < nnls.num_passive(); ++i) EXPECT_GT(nnls.weight(i), 0);
  EXPECT_LE(nnls.num_passive(), static_cast<std::size_t>(A.rows()));
  EXPECT_NEAR(nnls.relative_residual(), r.norm() / b.norm(), 1e-12);
  const Vector g = A.transpose() * r; // KKT: no ascent anywhere, none at all where w > 0
  const double scale = A.colwise().norm().maxCoeff() * b.norm();
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    EXPECT_LT(g[j], 1e-11 * scale);
    if (w[j] > 0) {
      EXPECT_GT(g[j], -1e-11 * scale);
    }
  }
}

Matrix random_matrix(Eigen::Index m, Eigen::Index n, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(m, n, [&] { return normal(random); });
}

TEST(Nnls, RandomProblemsAgreeWithThePlainMethod) {
  std::mt19937 random(7);
  for (int problem = 0; problem < 60; ++problem) {
    const Eigen::Index m = 2 + problem % 17, n = 3 + problem % 29;
    const Matrix A = random_matrix(m, n, random);
    const Vector b = random_matrix(m, 1, random);
    Nnls nnls;
    nnls.start(data(b));
    add(nnls, A);
    nnls.solve(1e-14, 1000);
    expect_optimal(nnls, A, b);
    EXPECT_NEAR((b - A * solution(nnls)).norm(), (b - A * reference_nnls(A, b)).norm(), 1e-10 * b.norm()) << problem;
  }
}

TEST(Nnls, ReachesAnyPointOfTheCone) {
  std::mt19937 random(8);
  for (const Eigen::Index m : {1, 5, 27, 64, 125}) {
    const Matrix A = random_matrix(m, 4 * m, random);
    const Vector b = A * random_matrix(4 * m, 1, random).cwiseAbs();
    Nnls nnls;
    nnls.start(data(b));
    add(nnls, A);
    EXPECT_EQ(nnls.solve(1e-12, static_cast<int>(10 * m)), Nnls::Status::Converged);
    EXPECT_LE((b - A * solution(nnls)).norm(), 1e-11 * b.norm());
    EXPECT_LE(nnls.num_passive(), static_cast<std::size_t>(m));
  }
}

TEST(Nnls, OneRow) {
  const Vector b = Vector::Constant(1, 2.0);
  Matrix A(1, 3);
  A << -1, 0, 4;
  Nnls nnls;
  nnls.start(data(b));
  add(nnls, A.leftCols(2));
  EXPECT_EQ(nnls.solve(1e-12, 10), Nnls::Status::NoAscent);
  EXPECT_EQ(nnls.num_passive(), 0u);
  add(nnls, A.rightCols(1));
  EXPECT_EQ(nnls.solve(1e-12, 10), Nnls::Status::Converged);
  EXPECT_DOUBLE_EQ(solution(nnls)[2], 0.5);
}

TEST(Nnls, DuplicatedAndDependentColumns) {
  std::mt19937 random(9);
  for (int problem = 0; problem < 20; ++problem) {
    const Matrix half = random_matrix(8, 10, random);
    Matrix A(8, 30);
    A << half, half, 2 * half; // each column three times
    A.col(29) = A.col(0) + A.col(1);
    const Vector b = random_matrix(8, 1, random);
    Nnls nnls;
    nnls.start(data(b));
    add(nnls, A);
    EXPECT_NE(nnls.solve(1e-14, 2000), Nnls::Status::OutOfSteps);
    expect_optimal(nnls, A, b);
  }
}

TEST(Nnls, RankDeficientRows) {
  std::mt19937 random(10);
  for (int problem = 0; problem < 20; ++problem) {
    const Matrix A = random_matrix(12, 4, random) * random_matrix(4, 40, random); // all columns in 4 dimensions
    const Vector b = A * random_matrix(40, 1, random).cwiseAbs();
    Nnls nnls;
    nnls.start(data(b));
    add(nnls, A);
    EXPECT_EQ(nnls.solve(1e-12, 2000), Nnls::Status::Converged);
    EXPECT_LE(nnls.num_passive(), 4u);
    EXPECT_LE((b - A * solution(nnls)).norm(), 1e-11 * b.norm());
  }
}

TEST(Nnls, ColumnsAddedLaterGiveTheSameMinimum) {
  std::mt19937 random(11);
  for (int problem = 0; problem < 20; ++problem) {
    const Matrix A = random_matrix(11, 37, random);
    const Vector b = random_matrix(11, 1, random);
    Nnls nnls;
    nnls.start(data(b));
    for (Eigen::Index from = 0; from < 37; from += 5) {
      add(nnls, A.middleCols(from, std::min<Eigen::Index>(5, 37 - from)));
      nnls.solve(1e-14, 1000);
    }
    expect_optimal(nnls, A, b);
  }
}

TEST(Nnls, ConvergedInTheLastStepAllowedIsConverged) {
  const Vector b = Vector::Constant(1, 3.0);
  const Matrix A = Matrix::Constant(1, 1, 1.5);
  Nnls nnls;
  nnls.start(data(b));
  add(nnls, A);
  EXPECT_EQ(nnls.solve(1e-12, 1), Nnls::Status::Converged);
}

TEST(Nnls, ZeroRightHandSideNeedsNoColumn) {
  const Vector b = Vector::Zero(3);
  Nnls nnls;
  nnls.start(data(b));
  add(nnls, Matrix::Identity(3, 3));
  EXPECT_EQ(nnls.solve(1e-12, 10), Nnls::Status::Converged);
  EXPECT_EQ(nnls.num_passive(), 0u);
}

} // namespace
} // namespace iga::prep
