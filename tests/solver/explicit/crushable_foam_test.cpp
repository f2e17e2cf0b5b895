#include "solver/explicit/laws/crushable_foam.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using Eigen::Matrix3d;

Curve epp_like() {
  return {{0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95},
          {0.22, 0.22, 0.29, 0.32, 0.35, 0.38, 0.43, 0.50, 0.64, 0.92, 1.7, 2.8, 5.5, 15},
          "EPP 60"};
}

FoamSettings epp() {
  return {.E = 20, .nu = 0, .density = 6e-11, .yield = epp_like(), .tension_limit = 0.25};
}

// The foam of the impact samples: steeper than E beyond a volumetric strain of 0.8.
FoamSettings impact_foam() {
  return {.E = 0.05,
          .nu = 0,
          .density = 6e-8,
          .yield = Curve({0, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95}, {3e-4, 3.5e-4, 6e-4, 1.2e-3, 4e-3, 0.02, 0.05}, "foam"),
          .tension_limit = 3e-4};
}

TEST(CrushableFoam, UniaxialCrushingFollowsTheCurveExactly) {
  const CrushableFoam foam(epp());
  EXPECT_FALSE(foam.warning());
  LawDriver point(foam);
  double area = 1;
  for (int i = 1; i <= 930; ++i) {
    const double gamma = i * 1e-3;
    point.step(diagonal(1 - gamma, 1, 1));
    if (gamma > 0.012) { // beyond the elastic line: 0.22 / 20
      EXPECT_NEAR(point.cauchy()(0, 0), -epp().yield.value(gamma), 1e-12 * epp().yield.value(gamma)) << gamma;
    }
    area = std::max(area, std::abs(point.cauchy()(1, 1)));
    EXPECT_NEAR(point.cauchy()(1, 1), 0, 1e-12);
  }
}

TEST(CrushableFoam, LateralFacesStayFreeInAnyDirection) {
  const Matrix3d R = rotation({1, 2, -1}, 0.8);
  LawDriver point{CrushableFoam(epp())};
  for (double gamma = 0.001; gamma < 0.9; gamma += 0.001) {
    point.step(R * diagonal(1, 1 - gamma, 1) * R.transpose());
    if (gamma > 0.012) {
      const Matrix3d expected = -epp().yield.value(gamma) * R.col(1) * R.col(1).transpose();
      EXPECT_LE((point.cauchy() - expected).norm(), 1e-12 * (1 + expected.norm()));
    }
  }
}

TEST(CrushableFoam, BiaxialAndVolumetricCrushing) {
  LawDriver two{CrushableFoam(epp())}, three{CrushableFoam(epp())};
  for (double s = 0.999; s > 0.6; s -= 0.001) { // deeper, Y rises faster than a spherical elastic state
    two.step(diagonal(s, s, 1));
    three.step(diagonal(s, s, s));
  }
  const double s = two.F()(0, 0);
  EXPECT_NEAR(two.cauchy()(0, 0), -epp().yield.value(1 - s * s), 1e-12);
  EXPECT_NEAR(two.cauchy()(1, 1), -epp().yield.value(1 - s * s), 1e-12);
  EXPECT_NEAR(two.cauchy()(2, 2), 0, 1e-12);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(three.cauchy()(a, a), -epp().yield.value(1 - s * s * s), 1e-12);
}

TEST(CrushableFoam, ShearCutsBothPrincipalStresses) {
  LawDriver point{CrushableFoam(epp())};
  Matrix3d F = Matrix3d::Identity();
  for (int i = 1; i <= 100; ++i) {
    F(0, 1) = i * 1e-3;
    point.step(F);
  }
  // γ = 0, so Y = 0.22 in compression and the limit 0.25 in tension; directions near ±45°, turned by the spin.
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(point.cauchy());
  EXPECT_NEAR(principal.eigenvalues()[0], -0.22, 1e-12);
  EXPECT_NEAR(principal.eigenvalues()[1], 0, 1e-12);
  EXPECT_NEAR(principal.eigenvalues()[2], 0.25, 1e-12);
}

TEST(CrushableFoam, TensionIsCutAtTheLimitAndWithoutOneAtTheYieldStress) {
  FoamSettings settings = epp();
  for (const double limit : {0.25, 0.0}) {
    settings.tension_limit = limit;
    LawDriver point{CrushableFoam(settings)};
    for (double s = 1.001; s < 1.2; s += 0.001) point.step(diagonal(1, 1, s));
    EXPECT_NEAR(point.cauchy()(2, 2), limit > 0 ? limit : 0.22, 1e-13);
    EXPECT_NEAR(point.cauchy()(0, 0), 0, 1e-13);
  }
}

// Load to γ = 0.5, unload into the tension cut, reload. Stress over logarithmic strain: unloading is a line of slope E.
TEST(CrushableFoam, CycleDissipatesTheAnalyticHysteresis) {
  FoamSettings settings = epp();
  settings.yield = Curve({0, 1}, {0.3, 0.3}, "plateau");
  settings.tension_limit = 0.1;
  LawDriver point{CrushableFoam(settings)};
  constexpr double Y = 0.3, T = 0.1, E = 20, turn = 0.5;
  const double end_of_tension = std::log(turn) + (Y + T) / E + 0.01; // logarithmic strain
  double work = 0;
  const auto go = [&](double from, double to, int steps) {
    for (int i = 1; i <= steps; ++i) {
      const double e = from + (to - from) * i / steps, before = point.P()(0, 0), s = point.F()(0, 0);
      point.step(diagonal(std::exp(e), 1, 1));
      work += (before + point.P()(0, 0)) / 2 * (std::exp(e) - s);
    }
  };
  go(0, std::log(turn), 20000);
  // Elastic rise to Y (σ = E ε, dF = e^ε dε), then P = σ = -Y over the rest
  const double e0 = -Y / E, rise = E * (1 - (1 - e0) * std::exp(e0));
  const double crush = rise + Y * (std::exp(e0) - turn);
  EXPECT_NEAR(work, crush, 1e-6 * crush);
  const double loaded = work;
  go(std::log(turn), end_of_tension, 4000);
  EXPECT_NEAR(point.cauchy()(0, 0), T, 1e-12);
  go(end_of_tension, std::log(turn), 4000);
  EXPECT_NEAR(point.cauchy()(0, 0), -Y, 1e-12);
  // Parallelogram in (log strain, σ) with sides (Y + T) and the 0.01 beyond the cut, against dF = e^ε dε.
  const auto line = [&](double a, double sigma_a, double b) { // ∫ (σ_a + E (ε - a)) e^ε dε
    return (sigma_a + E * (b - a)) * std::exp(b) - sigma_a * std::exp(a) - E * (std::exp(b) - std::exp(a));
  };
  const double a = std::log(turn), cut = a + (Y + T) / E, back = end_of_tension - (Y + T) / E;
  const double loop = line(a, -Y, cut) + T * (std::exp(end_of_tension) - std::exp(cut)) +
                      line(end_of_tension, T, back) - Y * (std::exp(a) - std::exp(back));
  EXPECT_NEAR(work - loaded, loop, 1e-5 * loop);
  EXPECT_NEAR(loop, (Y + T) * 0.01 * turn, 0.1 * loop); // the trapezoid itself
}

TEST(CrushableFoam, SuperposedRotationTurnsTheStress) {
  const Eigen::Vector3d axis(1, -2, 0.5);
  LawDriver plain{CrushableFoam(epp())}, turned{CrushableFoam(epp())};
  const auto deformation = [](double s) { return diagonal(1 - 0.5 * s, 1 - 0.1 * s, 1 + 0.02 * s); };
  plain.path(deformation, 2000);
  turned.path([&](double s) -> Matrix3d { return rotation(axis, 2 * s) * deformation(s); }, 2000);
  const Matrix3d R = rotation(axis, 2);
  EXPECT_LE((turned.cauchy() - R * plain.cauchy() * R.transpose()).norm(), 2e-3 * plain.cauchy().norm());
  // A rigid rotation keeps it to round-off, in one step and in many.
  LawDriver once = plain, often = plain;
  once.step(R * plain.F());
  EXPECT_LE((once.cauchy() - R * plain.cauchy() * R.transpose()).norm(), 1e-14);
  often.path([&](double s) -> Matrix3d { return rotation(axis, 2 * s) * plain.F(); }, 500);
  EXPECT_LE((often.cauchy() - R * plain.cauchy() * R.transpose()).norm(), 1e-12);
}

TEST(CrushableFoam, ImpactFoamWarnsAndKeepsItsModulus) {
  const CrushableFoam foam(impact_foam());
  ASSERT_TRUE(foam.warning());
  EXPECT_NE(foam.warning()->find("steeper"), std::string::npos);
  EXPECT_NEAR(foam.small_strain().C(0, 0), 0.05, 1e-15);
  LawDriver point(foam);
  for (double gamma = 5e-4; gamma < 0.97; gamma += 5e-4) {
    point.step(diagonal(1 - gamma, 1, 1));
    const double Y = impact_foam().yield.value(gamma), sigma = -point.cauchy()(0, 0);
    EXPECT_LE(sigma, Y * (1 + 1e-12));
    if (gamma > 0.007 && gamma < 0.7) {
      EXPECT_NEAR(sigma, Y, 1e-12);
    }
  }
  // In the reference metric: ρ c² = max(E / (1 - γ), dY/dγ), here the elastic unloading.
  EXPECT_GE(6e-8 * point.out.wave_speed_squared[0], 0.05 / point.F()(0, 0) * (1 - 1e-12));
}

TEST(CrushableFoam, FinalSlopeAsModulusFollowsTheCurveToTheEnd) {
  FoamSettings settings = impact_foam();
  settings.modulus = FoamModulus::FinalSlope;
  const CrushableFoam foam(settings);
  EXPECT_NEAR(foam.small_strain().C(0, 0), 0.6, 1e-12);
  EXPECT_FALSE(foam.warning());
  LawDriver point(foam);
  for (double gamma = 5e-4; gamma < 0.975; gamma += 5e-4) point.step(diagonal(1 - gamma, 1, 1));
  const double gamma = 1 - point.F()(0, 0); // extrapolated with the last slope
  EXPECT_NEAR(point.cauchy()(0, 0), -(0.05 + 0.6 * (gamma - 0.95)), 1e-12);
}

template <class Prepare> void expect_bound(const FoamSettings& settings, Prepare prepare) {
  LawDriver point{CrushableFoam(settings)};
  prepare(point);
  const double bound = settings.density * point.out.wave_speed_squared[0];
  EXPECT_LE(point.acoustic_maximum(1e-7), bound * (1 + 1e-5));
}

TEST(CrushableFoam, WaveSpeedBoundsTheAcousticTensor) {
  const double at_rest = 20;
  LawDriver fresh{CrushableFoam(epp())};
  fresh.step(Matrix3d::Identity());
  EXPECT_NEAR(epp().density * fresh.out.wave_speed_squared[0], at_rest, 1e-6 * at_rest);
  EXPECT_NEAR(fresh.acoustic_maximum(), at_rest, 1e-5 * at_rest);
  RandomTensors random;
  FoamSettings steep = impact_foam(), with_nu = epp();
  with_nu.nu = 0.2;
  for (const FoamSettings& settings : {epp(), with_nu, steep})
    for (int i = 0; i < 12; ++i) {
      const Matrix3d R = random.turn();
      const double depth = 0.1 + 0.85 * std::abs(random.tensor(1)(0, 0)), side = 0.2 * random.tensor(1)(0, 0);
      for (const double back : {0.0, 0.003}) // crushing, and a little unloaded
        expect_bound(settings, [&](auto& point) {
          point.path([&](double s) -> Matrix3d { return R * diagonal(1 - depth * s, 1 + side * s, 1) * R.transpose(); },
                     2000);
          point.step(point.F() * (1 + back));
        });
    }
}

TEST(CrushableFoam, DampingAddsStressAndPower) {
  FoamSettings settings = epp();
  settings.damping = 0.1;
  constexpr double h = 4, dt = 1e-7;
  LawDriver damped(CrushableFoam(settings), h), plain(CrushableFoam(epp()), h);
  const Matrix3d before = diagonal(0.8, 1, 1), after = diagonal(0.79, 1, 1);
  for (auto* point : {&damped, &plain}) {
    point->step(before, 0);
    point->step(after, dt);
  }
  const double rate = -0.01 / 0.795 / dt, c = std::sqrt(20 / settings.density), l = h * 0.79;
  const double viscous = 0.1 * settings.density * c * l * rate;
  EXPECT_NEAR(damped.cauchy()(0, 0) - plain.cauchy()(0, 0), viscous, 1e-12 * std::abs(viscous));
  EXPECT_NEAR(damped.out.viscous_power[0], 0.79 * viscous * rate, 1e-10 * std::abs(viscous * rate));
  EXPECT_EQ(plain.out.viscous_power[0], 0);
  EXPECT_NEAR(damped.out.damping_ratio[0], 0.1 * std::sqrt(0.79), 1e-2 * 0.1); // elastic wave: β √J
  LawDriver later = damped;                                                    // no memory of the damping
  later.step(after, dt);
  EXPECT_NEAR(later.cauchy()(0, 0), plain.cauchy()(0, 0), 1e-13);
}

TEST(CrushableFoam, PointsThatInvertAreFrozenAndPushBack) {
  LawDriver point{CrushableFoam(epp())};
  point.path([](double s) { return diagonal(1 - 0.975 * s, 1, 1); }, 3000);
  EXPECT_EQ(count(point.out.inverted), 0);
  double last = point.P()(0, 0);
  for (double s = 0.0195; s > -0.5; s -= 0.005) {
    point.step(diagonal(s, 1, 1));
    EXPECT_EQ(count(point.out.inverted), 8);
    EXPECT_LT(point.P()(0, 0), last); // stiffer all the way
    EXPECT_TRUE(std::isfinite(point.out.wave_speed_squared[0]));
    last = point.P()(0, 0);
  }
  point.step(diagonal(0.03, 1, 1));
  point.step(diagonal(0.031, 1, 1));
  EXPECT_EQ(count(point.out.inverted), 0);
  EXPECT_TRUE(point.P().allFinite());
}

std::string message_of(const FoamSettings& settings) {
  try {
    CrushableFoam{settings};
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CrushableFoam, RefusesWhatMakesNoSense) {
  FoamSettings s = epp();
  s.yield = Curve({0, 0.5}, {0, 1}, "c");
  EXPECT_NE(message_of(s).find("Y(0) = 0"), std::string::npos);
  s.yield = Curve({0, 0.5}, {1, 0.5}, "c");
  EXPECT_NE(message_of(s).find("falls"), std::string::npos);
  s = epp();
  s.yield = Curve({0}, {1}, "c");
  EXPECT_EQ(message_of(s), "");
  s.modulus = FoamModulus::FinalSlope;
  EXPECT_NE(message_of(s).find("lcid_final_slope"), std::string::npos);
  s = epp();
  s.tension_limit = -1;
  EXPECT_NE(message_of(s).find("tension_limit"), std::string::npos);
  s = epp();
  s.damping = 2;
  EXPECT_NE(message_of(s).find("damping"), std::string::npos);
  s = epp();
  s.E = 0;
  EXPECT_NE(message_of(s).find("Young"), std::string::npos);
}

} // namespace
} // namespace iga::solve
