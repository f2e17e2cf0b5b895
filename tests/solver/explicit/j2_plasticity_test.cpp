#include "solver/explicit/laws/j2_plasticity.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using Eigen::Matrix3d;

constexpr double E = 117e3, nu = 0.35, mu = E / (2 * (1 + nu)), bulk = E / (3 * (1 - 2 * nu));

// Copper of the Taylor bar, t-mm-s: 400 MPa, linear hardening 100 MPa.
J2Settings copper() {
  return {.E = E, .nu = nu, .density = 8.93e-9, .yield = Curve({0, 1}, {400, 500}, "hardening")};
}

double equivalent(const Matrix3d& sigma) {
  const Matrix3d s = sigma - sigma.trace() / 3 * Matrix3d::Identity();
  return std::sqrt(1.5) * s.norm();
}

Matrix3d shear(double g) {
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = g;
  return F;
}

// A column whose sides are free: finds the lateral stretch of every step by the secant method.
template <class Law> void stretch_freely(LawDriver<Law>& point, double stretch, double dt = 0) {
  double a = point.F()(1, 1), b = a * (1 - 1e-6);
  const auto lateral = [&](double s) {
    LawDriver<Law> copy = point;
    copy.step(diagonal(stretch, s, s), dt);
    return copy.cauchy()(1, 1);
  };
  double ra = lateral(a), rb = lateral(b);
  for (int i = 0; i < 30 && std::abs(rb) > 1e-11 * E && rb != ra; ++i) {
    const double next = b - rb * (b - a) / (rb - ra);
    a = b, ra = rb;
    b = next, rb = lateral(b);
  }
  point.step(diagonal(stretch, b, b), dt);
}

TEST(J2Plasticity, UniaxialTensionFollowsTheHardeningCurve) {
  J2Settings settings = copper();
  settings.yield = Curve({0, 0.002, 0.01, 0.05, 0.2}, {300, 380, 420, 500, 560}, "hardening");
  LawDriver point{J2Plasticity(settings)};
  for (int i = 1; i <= 300; ++i) {
    const double strain = i * 1e-3;
    stretch_freely(point, std::exp(strain));
    const double sigma = point.cauchy()(0, 0), plastic = strain - sigma / E;
    if (plastic > 1e-6) {
      EXPECT_NEAR(sigma, settings.yield.value(plastic), 2e-4 * sigma) << strain;
    }
  }
  const double before = point.cauchy()(0, 0); // unloads along E
  stretch_freely(point, point.F()(0, 0) * std::exp(-1e-3));
  EXPECT_NEAR(before - point.cauchy()(0, 0), E * 1e-3, 1e-3 * E * 1e-3);
}

// Several pieces of the curve inside one step: the end lies on the curve to round-off.
TEST(J2Plasticity, ReturnIsExactForOneLargeStep) {
  J2Settings settings = copper();
  settings.yield = Curve({0, 0.002, 0.01, 0.05, 0.2}, {300, 380, 420, 500, 560}, "hardening");
  for (const double g : {0.003, 0.006, 0.01, 0.03, 0.1}) { // simple shear: strain g/2 at the midpoint, spin g/2
    LawDriver point{J2Plasticity(settings)};
    point.step(shear(g));
    const double trial = std::sqrt(3.0) * mu * g, q = equivalent(point.cauchy());
    EXPECT_NEAR(q, std::min(trial, settings.yield.value((trial - q) / (3 * mu))), 1e-10 * q);
    EXPECT_NEAR(point.cauchy()(0, 1), q / std::sqrt(3.0), 1e-10 * q); // no stress to turn yet
    EXPECT_NEAR(point.cauchy().trace(), 0, 1e-9);
  }
  LawDriver point{J2Plasticity(settings)};
  point.step(diagonal(1.2, 1, 1)); // no spin: strain 2 (s - 1)/(s + 1)
  const double e = 2 * 0.2 / 2.2, trial = 2 * mu * e, q = equivalent(point.cauchy());
  EXPECT_NEAR(q, settings.yield.value((trial - q) / (3 * mu)), 1e-10 * q);
  EXPECT_NEAR(point.cauchy().trace() / 3, bulk * e, 1e-10 * bulk * e);
}

TEST(J2Plasticity, VolumetricLoadStaysElasticAndReturns) {
  LawDriver point{J2Plasticity(copper())};
  point.path([](double s) { return diagonal(1 - 0.1 * s, 1 - 0.1 * s, 1 - 0.1 * s); }, 500);
  EXPECT_NEAR(point.cauchy()(1, 1), 3 * bulk * std::log(0.9), 1e-5 * bulk);
  EXPECT_NEAR(equivalent(point.cauchy()), 0, 1e-8);
  point.path([](double s) { return diagonal(0.9 + 0.1 * s, 0.9 + 0.1 * s, 0.9 + 0.1 * s); }, 500);
  EXPECT_NEAR(point.cauchy().norm(), 0, 1e-8 * bulk);
}

TEST(J2Plasticity, BiaxialStretchWithAFreeFaceYieldsLikeCompression) {
  LawDriver point{J2Plasticity(copper())};
  // Thickness strain from an incompressible plastic flow; pressure is then whatever it is, q has to lie on the curve.
  point.path([](double s) { return diagonal(1 + 0.1 * s, 1 + 0.1 * s, std::pow(1 + 0.1 * s, -2)); }, 1000);
  const double q = equivalent(point.cauchy()), total = 2 * std::log(1.1);
  EXPECT_NEAR(q, 400 + 100 * (total - q / (3 * mu)), 1e-3 * q);
  EXPECT_NEAR(point.cauchy()(0, 0) - point.cauchy()(2, 2), q, 1e-6 * q);
}

TEST(J2Plasticity, RateFactorsScaleTheYieldStress) {
  J2Settings settings = copper();
  settings.yield = Curve({0}, {400}, "perfectly plastic");
  for (const auto kind : {RateFactor::Kind::CowperSymonds, RateFactor::Kind::JohnsonCook})
    for (const double rate : {1e-3, 1.0, 1e3, 1e5})
      for (const double step : {1e-5, 1e-3}) {
        settings.rate = kind == RateFactor::Kind::CowperSymonds
                            ? RateFactor{.kind = kind, .rate = 40, .exponent = 5}
                            : RateFactor{.kind = kind, .rate = 1, .exponent = 0.025};
        LawDriver point{J2Plasticity(settings)};
        const auto isochoric = [](double e) { return diagonal(std::exp(e), std::exp(-e / 2), std::exp(-e / 2)); };
        for (double e = step; e < 40 * step + 0.06; e += step) point.step(isochoric(e), step / rate);
        const double q = equivalent(point.cauchy());
        EXPECT_NEAR(q, 400 * settings.rate.value(rate), 1e-4 * q) << rate; // midpoint strain of a step: to step²
      }
}

TEST(J2Plasticity, RateFactorsAreSolvedToRoundOffInOneStep) {
  J2Settings settings = copper();
  settings.yield = Curve({0, 0.01, 0.05}, {300, 420, 500}, "hardening");
  for (const auto kind : {RateFactor::Kind::CowperSymonds, RateFactor::Kind::JohnsonCook})
    for (const double dt : {1e-9, 1e-7, 1e-5, 1e-2, 1e3})
      for (const double size : {0.004, 0.02, 0.3}) {
        settings.rate = {.kind = kind,
                         .rate = kind == RateFactor::Kind::CowperSymonds ? 40.0 : 1.0,
                         .exponent = kind == RateFactor::Kind::CowperSymonds ? 5 : 0.025};
        LawDriver point{J2Plasticity(settings)};
        point.step(diagonal(1 + size, 1, 1), dt);
        const double trial = 2 * mu * 2 * size / (2 + size), q = equivalent(point.cauchy());
        const double plastic = (trial - q) / (3 * mu);
        ASSERT_GE(plastic, -1e-15);
        const double expected = settings.yield.value(plastic) * settings.rate.value(std::max(plastic, 0.0) / dt);
        EXPECT_NEAR(q, expected, 1e-7 * q) << dt << " " << size; // plastic itself is a difference
      }
}

TEST(J2Plasticity, RigidRotationTurnsTheStressExactly) {
  const Eigen::Vector3d axis(1, -2, 0.5);
  LawDriver point{J2Plasticity(copper())};
  point.path([](double s) { return diagonal(1 - 0.1 * s, 1 + 0.05 * s, 1); }, 100);
  const Matrix3d F = point.F(), sigma = point.cauchy(), R = rotation(axis, 2);
  LawDriver once = point, often = point;
  once.step(R * F);
  EXPECT_LE((once.cauchy() - R * sigma * R.transpose()).norm(), 1e-13 * sigma.norm());
  often.path([&](double s) -> Matrix3d { return rotation(axis, 2 * s) * F; }, 500);
  EXPECT_LE((often.cauchy() - R * sigma * R.transpose()).norm(), 1e-11 * sigma.norm());
}

TEST(J2Plasticity, WaveSpeedBoundsTheAcousticTensor) {
  const double at_rest = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  LawDriver fresh{J2Plasticity(copper())};
  fresh.step(Matrix3d::Identity());
  EXPECT_NEAR(copper().density * fresh.out.wave_speed_squared[0], at_rest, 1e-7 * at_rest);
  RandomTensors random;
  for (int i = 0; i < 10; ++i) {
    LawDriver point{J2Plasticity(copper())};
    const Matrix3d H = random.tensor(0.3);
    point.path([&](double s) -> Matrix3d { return Matrix3d::Identity() + s * H; }, 200);
    EXPECT_LE(point.acoustic_maximum(1e-7), copper().density * point.out.wave_speed_squared[0] * (1 + 1e-5));
    point.step(point.F() * 1.0001); // elastic now
    EXPECT_LE(point.acoustic_maximum(1e-7), copper().density * point.out.wave_speed_squared[0] * (1 + 1e-5));
  }
}

std::string message_of(const J2Settings& settings) {
  try {
    J2Plasticity{settings};
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(J2Plasticity, RefusesWhatMakesNoSense) {
  J2Settings s = copper();
  s.yield = Curve({0.1, 0.5}, {1, 2}, "c");
  EXPECT_NE(message_of(s).find("plastic strain 0"), std::string::npos);
  s.yield = Curve({0, 0.5}, {2, 1}, "c");
  EXPECT_NE(message_of(s).find("falls"), std::string::npos);
  s.yield = Curve({0, 0.5}, {0, 1}, "c");
  EXPECT_NE(message_of(s).find("positive"), std::string::npos);
  s = copper();
  s.rate = {.kind = RateFactor::Kind::CowperSymonds, .rate = 0, .exponent = 5};
  EXPECT_NE(message_of(s).find("rate"), std::string::npos);
}

} // namespace
} // namespace iga::solve
