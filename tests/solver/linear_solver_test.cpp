// Factorised systems: solutions against the matrix they were made from, inertia of known matrices, refusals.
#include "solver/linalg/linear_solver.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/free_memory.hpp"
#include "solver/linalg/node_ordering.hpp"
#include "tests/solver/eigen_support.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace iga;
using namespace iga::solve;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const ElasticMaterial rubber = isotropic(2.5, 0.25, 1.3);

test::System small_system(int p, double cut) {
  return {test::make_box_model(test::box_in_grid({1, 1.2, 0.8}, {3, 3, 2}, p, cut)), rubber};
}

VectorXd some_vector(Eigen::Index n, double seed) {
  VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = std::sin(seed + 1.7 * static_cast<double>(i));
  return v;
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

// A diagonal stiffness over some pattern: entry i of `diagonal` repeated along the unknowns.
StiffnessMatrix diagonal_matrix(const std::shared_ptr<const Connectivity>& connectivity,
                                const std::vector<double>& diagonal) {
  StiffnessMatrix K(connectivity);
  const auto& pattern = K.pattern();
  std::size_t next = 0;
  for (std::size_t j = 0; j + 1 < pattern.offsets.size(); ++j) {
    const auto first = static_cast<std::size_t>(pattern.offsets[j]);
    const auto rows = static_cast<std::size_t>(pattern.offsets[j + 1]) - first;
    for (std::size_t b = 0; b < 3; ++b) K.values()[9 * first + 3 * b * rows + b] = diagonal[next++ % diagonal.size()];
  }
  return K;
}

ConstraintMatrix first_unknowns_sum(std::int64_t n, std::int64_t count, bool twice) {
  ConstraintMatrix C(twice ? 2 : 1, n);
  for (int r = 0; r < C.rows(); ++r)
    for (std::int64_t i = 0; i < count; ++i) C.insert(r, i) = (r + 1) * (1 + 0.1 * static_cast<double>(i));
  C.makeCompressed();
  return C;
}

} // namespace

TEST(CholeskySolver, SolvesShiftedSystemsOfEveryDegreeAndManyColumns) {
  for (int p = 1; p <= 3; ++p) {
    const test::System s = small_system(p, 0.3);
    const std::int64_t n = s.K.size();
    const auto solver = factorise_positive_definite({.stiffness = &s.K, .mass = s.M.matrix(), .shift = -0.7});
    ASSERT_EQ(solver->size(), n);
    MatrixXd B(n, 5), X(n, 5);
    for (Eigen::Index c = 0; c < 5; ++c) B.col(c) = s.K * some_vector(n, static_cast<double>(c));
    solver->solve(B.data(), X.data(), 5);
    for (Eigen::Index c = 0; c < 5; ++c) {
      for (const VectorXd& x : {VectorXd(X.col(c)), solver->solve(VectorXd(B.col(c)))}) {
        const VectorXd defect = s.K * x + 0.7 * (s.M * x) - B.col(c);
        EXPECT_LT(defect.norm(), 1e-10 * B.col(c).norm()) << "degree " << p;
      }
    }
    EXPECT_GT(solver->cost().nonzeros, n);
    EXPECT_GT(solver->cost().bytes, 8.0 * static_cast<double>(solver->cost().nonzeros));
  }
}

TEST(CholeskySolver, RowsOfVanishingFunctionsKeepTheirDigits) {
  // Cut to 1e-4 of a span at p = 3, functions at the far corner hold less than 1e-30 of a full one's mass.
  const test::System s = small_system(3, 1e-4);
  const VectorXd mass = s.M.matrix()->diagonal();
  ASSERT_LT(mass.minCoeff(), 1e-30 * mass.maxCoeff());
  const auto solver = factorise_positive_definite({.stiffness = &s.K, .mass = s.M.matrix(), .shift = -1});
  const VectorXd u = s.problem().motions.col(4); // K u = 0: exact solution known for b = M u
  const VectorXd b = s.M * u;
  EXPECT_LT((s.K * solver->solve(b)).norm(), 1e-6 * (s.K * some_vector(b.size(), 1)).norm());
  const VectorXd x = solver->solve(b), d = x - u;
  EXPECT_LT(std::sqrt(d.dot(s.M * d)), 1e-9 * std::sqrt(u.dot(b)));
}

TEST(CholeskySolver, FactorisesLumpedAndConsistentMass) {
  const test::System s = small_system(2, 0.5);
  const VectorXd lumped = s.M.matrix()->row_sums();
  const auto solver = factorise_positive_definite({.stiffness = &s.K, .lumped_mass = &lumped, .shift = -2});
  const VectorXd b = some_vector(s.K.size(), 0.3), x = solver->solve(b);
  VectorXd defect = s.K * x - b;
  for (Eigen::Index i = 0; i < lumped.size(); ++i) defect.segment<3>(3 * i) += 2 * lumped[i] * x.segment<3>(3 * i);
  EXPECT_LT(defect.norm(), 1e-11 * b.norm());

  const auto mass_solver = factorise_mass(*s.M.matrix());
  ASSERT_EQ(3 * mass_solver->size(), s.K.size());
  VectorXd y(s.K.size());
  s.M.divide(b.data(), y.data(), 1);
  EXPECT_LT((s.M * y - b).norm(), 1e-9 * b.norm());
}

TEST(CholeskySolver, AFreeBodyIsRefusedWithTheReason) {
  const test::System s = small_system(2, 1);
  EXPECT_THROW(factorise_positive_definite({.stiffness = &s.K}), NumericalError);
  EXPECT_NE(message_of([&] { factorise_positive_definite({.stiffness = &s.K}); }).find("rigid motion"),
            std::string::npos);
}

TEST(IndefiniteSolver, SolvesConstrainedSystemsAndFindsRedundantConstraints) {
  const test::System s = small_system(2, 0.6);
  const std::int64_t n = s.K.size();
  for (const bool twice : {false, true}) {
    const ConstraintMatrix C = first_unknowns_sum(n, 30, twice);
    const SystemMatrix system{.stiffness = &s.K, .mass = s.M.matrix(), .shift = -0.5, .constraints = &C};
    const auto solver = factorise_indefinite(system);
    ASSERT_EQ(solver->size(), n + C.rows());
    MatrixXd B = MatrixXd::Zero(n + C.rows(), 2), X(n + C.rows(), 2);
    B.topRows(n).col(0) = some_vector(n, 0);
    B.topRows(n).col(1) = some_vector(n, 3);
    B.bottomRows(C.rows()).col(1) = VectorXd::LinSpaced(C.rows(), 1, static_cast<double>(C.rows())); // 1 (, 2)
    solver->solve(B.data(), X.data(), 2);
    for (Eigen::Index c = 0; c < 2; ++c) {
      const VectorXd x = X.col(c).head(n);
      const VectorXd defect = s.K * x + 0.5 * (s.M * x) + C.transpose() * X.col(c).tail(C.rows()) - B.col(c).head(n);
      EXPECT_LT(defect.norm(), 1e-9 * B.col(c).norm());
      EXPECT_LT((C * x - B.col(c).tail(C.rows())).norm(), 1e-10 * (C.cwiseAbs() * x.cwiseAbs()).norm());
    }
    const Inertia counts = inertia(system);
    EXPECT_EQ(counts.negative, 1);
    EXPECT_EQ(counts.zero, twice ? 1 : 0);
    EXPECT_EQ(counts.positive, n);
  }
}

TEST(Inertia, CountsSignsOfKnownMatrices) {
  const test::System s = small_system(1, 1);
  const std::int64_t n = s.K.size();
  const std::vector<double> diagonal{3, -1e-8, 0, 2e5, 4, -7, 1};
  const StiffnessMatrix K = diagonal_matrix(s.connectivity, diagonal);
  Inertia expected;
  for (std::int64_t i = 0; i < n; ++i) {
    const double d = diagonal[static_cast<std::size_t>(i) % diagonal.size()];
    ++(d < 0 ? expected.negative : d > 0 ? expected.positive : expected.zero);
  }
  const Inertia counts = inertia({.stiffness = &K});
  EXPECT_EQ(counts.negative, expected.negative);
  EXPECT_EQ(counts.zero, expected.zero);
  EXPECT_EQ(counts.positive, expected.positive);
}

TEST(Inertia, AgreesWithDenseEigenvaluesOfAShiftedPair) {
  const test::System s = small_system(2, 0.7);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> dense(test::dense(s.K, s.K.size()),
                                                                 test::dense(s.M, s.K.size()), Eigen::EigenvaluesOnly);
  for (const int below : {6, 9, 40, 100}) {
    const double shift = 0.5 * (dense.eigenvalues()[below - 1] + dense.eigenvalues()[below]);
    EXPECT_EQ(inertia({.stiffness = &s.K, .mass = s.M.matrix(), .shift = shift}).negative, below);
  }
}

TEST(NodeOrdering, IsAPermutationAndSavesFill) {
  const test::System s{test::make_box_model(test::box_in_grid({1, 1, 1}, {8, 8, 8}, 1)), rubber};
  auto order = order_nodes(s.K.pattern());
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 0; k < sorted.size(); ++k) ASSERT_EQ(sorted[k], static_cast<std::int64_t>(k));
  const auto expanded = expand_order(order, 3);
  ASSERT_EQ(expanded.size(), 3 * order.size());
  EXPECT_EQ(expanded[4], 3 * order[1] + 1);
  // The band of a 9 × 9 × 9 lattice in its own order would hold about 3 · 91 entries per row.
  const auto solver = factorise_positive_definite({.stiffness = &s.K, .mass = s.M.matrix(), .shift = -1});
  EXPECT_LT(solver->cost().nonzeros, s.K.size() * 3 * 91 * 2 / 3);
}

TEST(FreeMemory, RefusesWhatDoesNotFitWithTheEstimate) {
  EXPECT_GT(free_memory(), 1e6);
  const FactorCost cost{.nonzeros = 3'000'000'000, .flops = 1e15, .bytes = 24.0 * 1024 * 1024 * 1024};
  EXPECT_NO_THROW(require_memory(cost, 1'000'000, 25.0 * 1024 * 1024 * 1024));
  EXPECT_THROW(require_memory(cost, 1'000'000, 8.0 * 1024 * 1024 * 1024), InputError);
  const std::string text = message_of([&] { require_memory(cost, 1'000'000, 8.0 * 1024 * 1024 * 1024); });
  EXPECT_NE(text.find("24 GiB"), std::string::npos) << text;
  EXPECT_NE(text.find("only 8 GiB"), std::string::npos) << text;
}
