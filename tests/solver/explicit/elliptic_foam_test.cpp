#include "solver/explicit/laws/elliptic_foam.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using Eigen::Matrix3d;

EllipticFoamSettings foam(double plastic_nu = 0) {
  return {.E = 20,
          .nu = 0.1,
          .density = 6e-11,
          .plastic_nu = plastic_nu,
          .yield = Curve({0, 0.3, 0.6, 0.9, 1.2}, {0.3, 0.35, 0.5, 1, 3}, "hardening")};
}

double alpha_squared(double plastic_nu) {
  return 4.5 * (1 - 2 * plastic_nu) / (1 + plastic_nu);
}

double equivalent(const Matrix3d& sigma, double plastic_nu) {
  const double p = sigma.trace() / 3, a = alpha_squared(plastic_nu);
  const Matrix3d s = sigma - p * Matrix3d::Identity();
  return std::sqrt((1.5 * s.squaredNorm() + a * p * p) / (1 + a / 9));
}

TEST(EllipticFoam, UniaxialCompressionYieldsAtTheCurveWithThePlasticRatio) {
  for (const double plastic_nu : {0.0, 0.2}) {
    // Sides follow the plastic ratio; elastic strains are small beside.
    EllipticFoamSettings settings = foam(plastic_nu);
    settings.E = 2e4;
    settings.nu = plastic_nu;
    LawDriver point{EllipticFoam(settings)};
    constexpr double end = 0.8;
    point.path(
        [&](double s) {
          const double side = std::exp(plastic_nu * end * s);
          return diagonal(std::exp(-end * s), side, side);
        },
        4000);
    const double Y = std::get<Curve>(settings.yield).value(end - 5e-5);
    EXPECT_NEAR(point.cauchy()(0, 0), -Y, 1e-3 * Y);
    EXPECT_NEAR(point.cauchy()(1, 1), 0, 1e-3 * Y); // associated: the flow of uniaxial stress is (-1, ν_p, ν_p)
  }
}

TEST(EllipticFoam, HydrostaticAndShearYield) {
  for (const double plastic_nu : {0.0, 0.2}) {
    EllipticFoamSettings settings = foam(plastic_nu);
    settings.yield = Curve({0}, {0.3}, "perfectly plastic");
    const double a = alpha_squared(plastic_nu), scale = std::sqrt(1 + a / 9);
    for (const double to : {0.9, 1.1}) {
      LawDriver point{EllipticFoam(settings)};
      point.path([&](double s) { return Matrix3d((1 + (to - 1) * s) * Matrix3d::Identity()); }, 100);
      EXPECT_NEAR(std::abs(point.cauchy()(0, 0)), 0.3 * scale / std::sqrt(a), 1e-12);
    }
    LawDriver sheared{EllipticFoam(settings)};
    Matrix3d F = Matrix3d::Identity();
    F(0, 1) = 0.1;
    sheared.step(F);
    EXPECT_NEAR(sheared.cauchy()(0, 1), 0.3 * scale / std::sqrt(3.0), 1e-12);
  }
}

// One step without rotation: stress on the surface, plastic strain along the normal, its length the hardening variable.
TEST(EllipticFoam, ReturnIsAssociatedAndExact) {
  RandomTensors random;
  const double lambda = 20 * 0.1 / (1.1 * 0.8), mu = 20 / 2.2;
  for (int i = 0; i < 50; ++i) {
    const EllipticFoamSettings settings = foam(0.1);
    const Matrix3d H = random.tensor(0.3), e = (H + H.transpose()) / 2;
    const Matrix3d F = (Matrix3d::Identity() - e / 2).inverse() * (Matrix3d::Identity() + e / 2); // strain e
    if (F.determinant() < 0.1) continue;
    LawDriver point{EllipticFoam(settings)};
    point.step(F);
    const Matrix3d trial = lambda * e.trace() * Matrix3d::Identity() + 2 * mu * e, sigma = point.cauchy();
    const Matrix3d d = trial - sigma; // C : Δε_p
    const Matrix3d plastic = (d - lambda / (3 * lambda + 2 * mu) * d.trace() * Matrix3d::Identity()) / (2 * mu);
    const double now = equivalent(sigma, 0.1), a = alpha_squared(0.1), p = sigma.trace() / 3;
    if (equivalent(trial, 0.1) < 0.3) {
      EXPECT_LE(d.norm(), 1e-14);
      continue;
    }
    const Matrix3d normal =
        (1.5 * (sigma - p * Matrix3d::Identity()) + a * p / 3 * Matrix3d::Identity()) / ((1 + a / 9) * now);
    const double length = plastic.cwiseProduct(sigma).sum() / now; // work-conjugate
    EXPECT_LE((plastic - length * normal).norm(), 1e-13);
    EXPECT_NEAR(now, std::get<Curve>(settings.yield).value(length), 1e-12 * now);
  }
}

TEST(EllipticFoam, DensificationHardeningFollowsItsFormula) {
  EllipticFoamSettings settings = foam();
  const DensificationHardening hardening{
      .plateau = 0.3, .linear = 0.1, .log = 2, .power = 4, .densification_strain = 1.8};
  settings.yield = hardening;
  settings.E = 2e4;
  settings.nu = 0;
  LawDriver point{EllipticFoam(settings)};
  for (double e = 1e-3; e < 1.7; e += 1e-3) {
    point.step(diagonal(std::exp(-e), 1, 1));
    const double sigma = -point.cauchy()(0, 0), z = (e - sigma / 2e4) / 1.8;
    EXPECT_NEAR(sigma, 0.3 + 0.1 * z - 2 * std::log(1 - std::pow(z, 4)), 1e-4 * sigma) << e;
  }
  point.step(diagonal(std::exp(-1.9), 1, 1)); // past densification: a tangent, no infinity
  EXPECT_TRUE(point.P().allFinite());
  EXPECT_EQ(count(point.out.inverted), 0);
}

TEST(EllipticFoam, RigidRotationTurnsTheStressAndTheWaveSpeedIsABound) {
  LawDriver point{EllipticFoam(foam())};
  point.path([](double s) { return diagonal(1 - 0.5 * s, 1 + 0.05 * s, 1); }, 500);
  EXPECT_LE(point.acoustic_maximum(1e-7), 6e-11 * point.out.wave_speed_squared[0] * (1 + 1e-5));
  LawDriver turned = point;
  const Matrix3d R = rotation({1, 2, 3}, 1.5);
  turned.step(R * point.F());
  EXPECT_LE((turned.cauchy() - R * point.cauchy() * R.transpose()).norm(), 1e-13);
}

TEST(EllipticFoam, RefusesWhatMakesNoSense) {
  EllipticFoamSettings s = foam(0.5);
  EXPECT_THROW(EllipticFoam{s}, InputError);
  s = foam();
  s.yield = DensificationHardening{};
  EXPECT_THROW(EllipticFoam{s}, InputError);
  s.yield = Curve({0, 1}, {1, 0.5}, "c");
  EXPECT_THROW(EllipticFoam{s}, InputError);
}

} // namespace
} // namespace iga::solve
