// Masses as operators, against dense matrices and the series they stand for.
#include "solver/mechanics/mass_operator.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/eigen_support.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const ElasticMaterial material = isotropic(1, 0.2, 3.0);
const test::BoxCase box = test::box_in_grid({1, 1, 1}, {3, 2, 2}, 2, 0.4);

MatrixXd inverse_of(const MassOperator& M) {
  MatrixXd D(M.size(), M.size());
  for (Eigen::Index i = 0; i < D.cols(); ++i) {
    const VectorXd e = VectorXd::Unit(M.size(), i);
    M.divide(e.data(), D.col(i).data(), 1);
  }
  return D;
}

MatrixXd diagonal(const VectorXd& nodes) {
  MatrixXd D = MatrixXd::Zero(3 * nodes.size(), 3 * nodes.size());
  for (Eigen::Index i = 0; i < nodes.size(); ++i) D.diagonal().segment<3>(3 * i).setConstant(nodes[i]);
  return D;
}

} // namespace

TEST(MassOperator, TotalMassIsDensityTimesVolumeForEveryType) {
  for (const MassType type : {MassType::Consistent, MassType::Lumped, MassType::TwoPass, MassType::ThreePass}) {
    const test::System s(test::make_box_model(box), material, type);
    EXPECT_NEAR(s.M.total(), 3.0, 1e-12);
    VectorXd ones = VectorXd::Zero(s.M.size());
    for (Eigen::Index i = 1; i < ones.size(); i += 3) ones[i] = 1;
    EXPECT_NEAR(ones.dot(s.M * ones), 3.0, 1e-11);
  }
}

TEST(MassOperator, MultiPassIsTheDenseSeriesSymmetricAndPositiveDefinite) {
  for (const int passes : {2, 3}) {
    const test::System s(test::make_box_model(box), material, passes == 2 ? MassType::TwoPass : MassType::ThreePass);
    const Eigen::Index n = s.M.size();
    MatrixXd consistent(n, n);
    for (Eigen::Index i = 0; i < n; ++i) consistent.col(i) = *s.M.matrix() * VectorXd(VectorXd::Unit(n, i));
    const MatrixXd lumped = diagonal(*s.M.masses());
    const MatrixXd R = MatrixXd::Identity(n, n) - lumped.inverse() * consistent;
    MatrixXd series = MatrixXd::Identity(n, n) + R;
    if (passes == 3) series += R * R;
    const MatrixXd inverse = inverse_of(s.M), root = lumped.cwiseSqrt();
    // Compared in units of the lumped mass: light functions count as much as heavy ones.
    const MatrixXd scaled = root * inverse * root, expected = root * series * lumped.inverse() * root;
    EXPECT_LT((scaled - expected).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((scaled - scaled.transpose()).cwiseAbs().maxCoeff(), 1e-13);
    const VectorXd spectrum = Eigen::SelfAdjointEigenSolver<MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(spectrum[0], 1 - 1e-12);
    EXPECT_LT(spectrum[n - 1], passes);
    const MatrixXd product = inverse * test::dense(s.M, n);
    EXPECT_LT((product - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(MassOperator, LumpedAndConsistentDivideUndoMultiply) {
  for (const MassType type : {MassType::Lumped, MassType::Consistent}) {
    const test::System s(test::make_box_model(box), material, type);
    VectorXd x(s.M.size()), y(s.M.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::cos(static_cast<double>(i * i));
    const VectorXd Mx = s.M * x;
    s.M.divide(Mx.data(), y.data(), 1);
    EXPECT_LT((y - x).norm(), 1e-8 * x.norm());
  }
}

TEST(MassOperator, LargestRatioOfConsistentToLumpedIsOneForThePlainBasis) {
  const test::System s(test::make_box_model(box), material);
  EXPECT_NEAR(largest_mass_ratio(*s.M.matrix(), s.M.matrix()->row_sums()), 1, 1e-3);
}

TEST(MassOperator, NegativeLumpedMassesAreRefused) {
  EXPECT_THROW(MassOperator::lumped(VectorXd::LinSpaced(4, -1, 2)), NumericalError);
}

TEST(MassOperator, MasslessFunctionsHaveNoInverseMass) {
  const MassOperator M = MassOperator::lumped(VectorXd::LinSpaced(3, 0, 2));
  const VectorXd x = VectorXd::Ones(9);
  VectorXd y(9);
  M.divide(x.data(), y.data(), 1);
  EXPECT_LT((y - (VectorXd(9) << 0, 0, 0, 1, 1, 1, 0.5, 0.5, 0.5).finished()).norm(), 1e-15);
}

TEST(SparedMasses, KeepTheTotalAndLeaveEveryNodeAShareOfItsOwn) {
  for (const double cut : {0.15, 0.4, 0.7})
    for (const double threshold : {0.01, 0.1, 0.3, 0.6}) {
      const TrimmedModel model = test::make_box_model(test::box_in_grid({4, 3, 3}, {5, 4, 4}, 2, cut));
      const SolutionSpace plain(model, {}), space(model, {LightFunctions::Linear, threshold});
      const SparedMasses spared = spare_masses(space, material.density);
      const VectorXd own = lumped_mass(plain, material.density);
      EXPECT_NEAR(spared.masses.sum(), own.sum(), 1e-12 * own.sum());
      for (Eigen::Index i = 0; i < spared.masses.size(); ++i)
        EXPECT_GT(spared.masses[i], 0.2 * own[space.node_unknowns()[static_cast<std::size_t>(i)]] * (1 - 1e-12));
      if (spared.moved == 0) {
        EXPECT_LT((spared.masses - lumped_mass(space, material.density)).norm(), 1e-14 * own.sum());
      }
    }
}
