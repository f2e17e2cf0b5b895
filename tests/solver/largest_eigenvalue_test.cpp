// The largest eigenfrequency against dense eigenvalues; the bound of the spans above it.
#include "solver/mechanics/largest_eigenvalue.hpp"

#include "solver/mechanics/element_bound.hpp"
#include "tests/solver/eigen_support.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using Eigen::MatrixXd;

namespace {

const ElasticMaterial steel = isotropic(210, 0.33, 7.8e-6);
constexpr MassType all_types[]{MassType::Consistent, MassType::Lumped, MassType::TwoPass, MassType::ThreePass};

double dense_omega(const test::System& s) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> dense(test::dense(s.K, s.K.size()),
                                                                 test::dense(s.M, s.K.size()), Eigen::EigenvaluesOnly);
  return std::sqrt(dense.eigenvalues().maxCoeff());
}

} // namespace

TEST(LargestEigenvalue, AgreesWithDenseEigenvaluesForEveryMass) {
  for (int p = 1; p <= 3; ++p)
    for (const MassType type : all_types) {
      const test::System s(test::make_box_model(test::box_in_grid({3, 2, 2}, {3, 2, 2}, p, 0.35)), steel, type);
      const double exact = dense_omega(s);
      const LargestEigenvalue largest = largest_eigenvalue(s.K, s.M, 1e-8);
      EXPECT_NEAR(largest.omega, exact, 1e-8 * exact) << "p " << p << " mass " << static_cast<int>(type);
      const Eigen::VectorXd defect = s.K * largest.mode - exact * exact * (s.M * largest.mode);
      EXPECT_LT(defect.norm(), 1e-2 * (s.K * largest.mode).norm());
      const LargestEigenvalue quick = largest_eigenvalue(s.K, s.M, 1e-3);
      EXPECT_LT(quick.omega, exact * (1 + 1e-9));
      EXPECT_GT(1.01 * quick.omega, exact);
    }
}

TEST(ElementBound, IsNeverBelowTheTrueValue) {
  for (int p = 1; p <= 3; ++p)
    for (const double cut : {1.0, 0.3, 0.01})
      for (const MassType type : {MassType::Lumped, MassType::TwoPass, MassType::ThreePass}) {
        const test::System s(test::make_box_model(test::box_in_grid({3, 2, 2}, {3, 2, 2}, p, cut)), steel, type);
        const auto bound = element_bound(s.space, s.material, type);
        ASSERT_TRUE(bound);
        const double omega = largest_eigenvalue(s.K, s.M, 1e-8).omega;
        EXPECT_GT(bound->omega, omega) << "p " << p << " cut " << cut;
        EXPECT_LT(bound->omega, 2.5 * omega);
      }
}

TEST(ElementBound, IsThatOfTheCardinalSpanForAWholeBox) {
  // omega h / c_L = 2.44 for an uncut span at p = 2; spans at the faces of an aligned box are cut by none.
  const test::BoxCase box = test::box_in_grid({4, 4, 4}, {4, 4, 4}, 2);
  const test::System s(test::make_box_model(box), steel, MassType::Lumped);
  const auto bound = element_bound(s.space, s.material, MassType::Lumped);
  ASSERT_TRUE(bound);
  EXPECT_NEAR(bound->omega / steel.fastest_wave(), 2.44, 0.01);
  EXPECT_FALSE(element_bound(s.space, s.material, MassType::Consistent));
}
