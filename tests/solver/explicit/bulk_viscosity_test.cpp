#include "solver/explicit/laws/bulk_viscosity.hpp"

#include "solver/explicit/laws/crushable_foam.hpp"
#include "solver/explicit/laws/neo_hookean.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using Eigen::Matrix3d;

constexpr double E = 10, nu = 0.3, rho = 2, h = 3, dt = 1e-2;

TEST(BulkViscosity, AddsThePressureOfItsFormulaInCompressionOnly) {
  const NeoHookean law = neo_hookean(E, nu, rho);
  for (const double change : {-0.01, 0.01}) {
    LawDriver plain(law, h);
    LawDriver viscous(BulkViscosity<NeoHookean>{.law = law}, h);
    const double s = 0.8;
    for (const double stretch : {s, s + change}) {
      plain.step(stretch * Matrix3d::Identity(), dt);
      viscous.step(stretch * Matrix3d::Identity(), dt);
    }
    const double J = std::pow(s + change, 3), J_old = std::pow(s, 3), rate = 2 * (J - J_old) / (J + J_old) / dt;
    const double l = h * (s + change), c = (s + change) * std::sqrt(plain.out.wave_speed_squared[0]);
    const double q = change < 0 ? rho / J * l * (1.5 * l * rate * rate - 0.06 * c * rate) : 0;
    EXPECT_NEAR(plain.cauchy()(1, 1) - viscous.cauchy()(1, 1), q, 1e-7 * q);
    EXPECT_NEAR(viscous.out.viscous_power[0], -q * rate * J, 1e-7 * std::abs(q * rate));
    EXPECT_NEAR(viscous.out.damping_ratio[0], 0.06 - 1.5 * l * std::min(rate, 0.0) / c, 1e-5);
    EXPECT_EQ(viscous.out.wave_speed_squared[0], plain.out.wave_speed_squared[0]);
  }
}

TEST(BulkViscosity, LeavesTheFirstEvaluationAndInvertedPointsAlone) {
  const NeoHookean law = neo_hookean(E, nu, rho);
  LawDriver plain(law, h);
  LawDriver viscous(BulkViscosity<NeoHookean>{.law = law}, h);
  for (const Matrix3d& F : {diagonal(0.9, 1, 1), diagonal(-0.2, 1, 1), diagonal(0.0, 1, 1)}) {
    const double step = F(0, 0) == 0.9 ? 0 : dt;
    plain.step(F, step);
    viscous.step(F, step);
    EXPECT_EQ(viscous.P(), plain.P());
    EXPECT_TRUE(std::isfinite(viscous.out.damping_ratio[0]));
  }
}

TEST(BulkViscosity, TurnsWithARotation) {
  const BulkViscosity<NeoHookean> law{.law = neo_hookean(E, nu, rho)};
  LawDriver plain(law, h), turned(law, h);
  const Matrix3d R = rotation({1, 2, 3}, 0.7), Q = rotation({0, 2, -1}, 1.3);
  plain.step(diagonal(0.9, 1.05, 1), dt);
  turned.step(R * plain.F(), dt);
  plain.step(diagonal(0.8, 1.1, 1), dt);
  turned.step(Q * plain.F(), dt);
  EXPECT_LE((turned.P() - Q * plain.P()).norm(), 1e-12 * plain.P().norm());
}

TEST(BulkViscosity, WrapsLawsWithHistory) {
  FoamSettings settings{.E = 20, .nu = 0, .density = 6e-11, .yield = Curve({0}, {0.3}, "plateau")};
  LawDriver point(BulkViscosity<CrushableFoam>{.law = CrushableFoam(settings)}, h);
  point.path([](double s) { return diagonal(1 - 0.5 * s, 1, 1); }, 500, 1.0); // slow: the pressure vanishes
  EXPECT_NEAR(point.cauchy()(0, 0), -0.3, 1e-6);
}

} // namespace
} // namespace iga::solve
