#include "solver/explicit/laws/linear_elastic.hpp"
#include "solver/explicit/laws/neo_hookean.hpp"
#include "solver/explicit/laws/st_venant_kirchhoff.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using Eigen::Matrix3d;

constexpr double E = 10, nu = 0.3, rho = 2;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));

// What resists full crushing: U(F) = M (r u(J / r) + r_s u(s / r_s)), s = J / |cof F|, r_s that of a column with J = r.
double u_of(double x) {
  const double last = 0.02, x0 = std::max(std::min(x, 1.0), last), over = std::min(x, 1.0) - x0, left = 1 - x0;
  const double slope = -left * left * (2 + x0) / (x0 * x0 * x0), curvature = 6 * left / (x0 * x0 * x0 * x0);
  return left * left * left / (x0 * x0) + slope * over + curvature / 2 * over * over;
}

double crushing_energy(const Matrix3d& F, double J_min) {
  Matrix3d cof;
  for (int b = 0; b < 3; ++b) cof.col(b) = F.col((b + 1) % 3).cross(F.col((b + 2) % 3));
  const double J = F.determinant();
  const double s_min = J_min / std::sqrt(1 + 2 * J_min * J_min);
  return (lambda + 2 * mu) * (J_min * u_of(J / J_min) + s_min * u_of(J / cof.norm() / s_min));
}

// Smallest stretch as the laws see it.
double flatness(const Matrix3d& F) {
  return F.determinant() / (F.determinant() * F.inverse()).norm();
}

double neo_hookean_energy(const Matrix3d& F, double J_min) {
  const double J = F.determinant(), clamped = std::max(J, J_min), ln = std::log(clamped);
  const double p = (lambda * ln - mu) / clamped, dp = (lambda + mu - lambda * ln) / (clamped * clamped);
  const double over = J - clamped; // second-order continuation
  return mu / 2 * (F.squaredNorm() - 3) - mu * ln + lambda / 2 * ln * ln + p * over + dp / 2 * over * over +
         crushing_energy(F, J_min);
}

template <class Energy> Matrix3d derivative(Energy energy, const Matrix3d& F, double step = 1e-5) {
  Matrix3d P;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const auto at = [&](double s) {
        Matrix3d moved = F;
        moved(a, b) += s;
        return energy(moved);
      };
      P(a, b) = (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step); // fourth order
    }
  return P;
}

TEST(NeoHookean, StressIsTheDerivativeOfTheEnergy) {
  LawDriver point(neo_hookean(E, nu, rho));
  RandomTensors random;
  for (int i = 0; i < 100; ++i) {
    const Matrix3d F = random.deformation(0.4);
    if (F.determinant() < 0.06 || flatness(F) < 0.06) continue;
    point.step(F);
    const Matrix3d P = derivative([](const Matrix3d& x) { return neo_hookean_energy(x, 0.05); }, F);
    EXPECT_LE((point.P() - P).norm(), 1e-7 * (1 + P.norm()));
    EXPECT_EQ(count(point.out.inverted), 0);
  }
}

TEST(NeoHookean, InvertedPointsKeepAStressThatIsTheDerivativeOfAnEnergy) {
  LawDriver point(neo_hookean(E, nu, rho));
  for (const double J : {0.049, 0.01, 0.002, 0.0, -0.3, -1.0}) {
    const Matrix3d F = rotation({1, 2, 3}, 0.4) * diagonal(1.1, 1.2, J / 1.32) * rotation({3, -2, 1}, 1.0);
    point.step(F);
    const Matrix3d P = derivative([](const Matrix3d& x) { return neo_hookean_energy(x, 0.05); }, F, 1e-6);
    EXPECT_LE((point.P() - P).norm(), 1e-5 * (1 + P.norm())) << J;
    EXPECT_EQ(count(point.out.inverted), 8);
    EXPECT_NEAR(point.out.J[3], J, 1e-14);
    EXPECT_LE(point.acoustic_maximum(), rho * point.out.wave_speed_squared[0] * (1 + 1e-6));
  }
}

TEST(NeoHookean, UniaxialBiaxialShearAndVolumetricClosedForms) {
  LawDriver point(neo_hookean(E, nu, rho));
  for (const double s : {0.4, 0.7, 1.0, 1.3, 2.5}) {
    point.step(diagonal(s, 1, 1)); // lateral faces held
    EXPECT_NEAR(point.P()(0, 0), mu * (s - 1 / s) + lambda * std::log(s) / s, 1e-12);
    EXPECT_NEAR(point.P()(1, 1), lambda * std::log(s), 1e-12);
    point.step(diagonal(s, s, 1));
    EXPECT_NEAR(point.P()(0, 0), mu * (s - 1 / s) + 2 * lambda * std::log(s) / s, 1e-12);
    EXPECT_NEAR(point.P()(2, 2), 2 * lambda * std::log(s), 1e-12);
    point.step(diagonal(s, s, s));
    EXPECT_NEAR(point.cauchy()(1, 1), (mu * (s * s - 1) + 3 * lambda * std::log(s)) / (s * s * s), 1e-11);
    Matrix3d shear = Matrix3d::Identity();
    shear(0, 1) = s;
    point.step(shear);
    EXPECT_NEAR(point.cauchy()(0, 1), mu * s, 1e-12);
    EXPECT_NEAR(point.cauchy()(0, 0), mu * s * s, 1e-12);
    EXPECT_NEAR(point.cauchy()(1, 1), 0, 1e-12);
  }
}

TEST(NeoHookean, LanesDoNotMix) {
  LawDriver together(neo_hookean(E, nu, rho)), alone(neo_hookean(E, nu, rho));
  RandomTensors random;
  std::array<Matrix3d, 8> F;
  for (Matrix3d& f : F) f = random.deformation(0.3);
  F[5] = diagonal(-1, 1, 1);
  together.step(F);
  EXPECT_EQ(count(together.out.inverted), 1);
  for (int l = 0; l < 8; ++l) {
    alone.step(F[static_cast<std::size_t>(l)]);
    EXPECT_EQ(together.P(l), alone.P());
    EXPECT_EQ(together.out.wave_speed_squared[l], alone.out.wave_speed_squared[0]);
    EXPECT_EQ(together.out.inverted[l], l == 5 ? -1 : 0);
  }
}

TEST(NeoHookean, ErodedAndStoppedPointsCarryNoStress) {
  for (const auto action : {InvertedPoints::Erode, InvertedPoints::Stop}) {
    LawDriver point(neo_hookean(E, nu, rho, {.action = action, .smallest_J = 0.2}));
    point.step(diagonal(0.21, 1, 1));
    EXPECT_EQ(count(point.out.inverted), 0);
    EXPECT_LT(point.P()(0, 0), -1);
    point.step(diagonal(0.19, 1, 1));
    EXPECT_EQ(count(point.out.inverted), 8);
    EXPECT_EQ(point.P(), Matrix3d::Zero());
    EXPECT_NEAR(point.out.wave_speed_squared[0], (lambda + 2 * mu) / rho, 1e-12);
  }
}

template <class Law> void expect_objective(Law law, double size) {
  LawDriver plain(law), turned(law);
  RandomTensors random;
  for (int i = 0; i < 50; ++i) {
    const Matrix3d F = random.deformation(size), R = random.turn();
    plain.step(F);
    turned.step(R * F);
    EXPECT_LE((turned.P() - R * plain.P()).norm(), 1e-13 * (1 + plain.P().norm()));
    EXPECT_NEAR(turned.out.wave_speed_squared[0], plain.out.wave_speed_squared[0],
                1e-7 * plain.out.wave_speed_squared[0]);
  }
}

template <class Law> void expect_wave_speed_bound(Law law, double size) {
  LawDriver point(law);
  const double at_rest = rho * law.reference_wave_speed() * law.reference_wave_speed();
  point.step(Matrix3d::Identity());
  EXPECT_NEAR(rho * point.out.wave_speed_squared[0], at_rest, 1e-7 * at_rest);
  EXPECT_NEAR(point.acoustic_maximum(), at_rest, 1e-6 * at_rest);
  RandomTensors random;
  for (int i = 0; i < 30; ++i) {
    const Matrix3d F = random.deformation(size);
    if (F.determinant() < 0.06) continue;
    point.step(F);
    const double bound = rho * point.out.wave_speed_squared[0], exact = point.acoustic_maximum();
    EXPECT_LE(exact, bound * (1 + 1e-6));
    EXPECT_GE(exact, 0.5 * bound); // no more careful than it has to be
  }
}

TEST(NeoHookean, Objective) {
  expect_objective(neo_hookean(E, nu, rho), 0.3);
}
TEST(NeoHookean, WaveSpeedBoundsTheAcousticTensor) {
  expect_wave_speed_bound(neo_hookean(E, nu, rho), 0.4);
}

double st_venant_energy(const Matrix3d& F) {
  const Matrix3d strain = (F.transpose() * F - Matrix3d::Identity()) / 2;
  const double below = std::min(F.determinant() - 0.05, 0.0), spring = (lambda + 2 * mu) / 0.05;
  return lambda / 2 * strain.trace() * strain.trace() + mu * strain.squaredNorm() + spring / 2 * below * below +
         crushing_energy(F, 0.05);
}

TEST(StVenantKirchhoff, StressIsTheDerivativeOfTheEnergyAlsoWhereInverted) {
  LawDriver point(st_venant_kirchhoff(E, nu, rho));
  RandomTensors random;
  for (int i = 0; i < 100; ++i) {
    const Matrix3d F = (i % 2 ? diagonal(-1, 1, 1) : Matrix3d::Identity()) * random.deformation(0.4);
    point.step(F);
    const Matrix3d P = derivative(st_venant_energy, F);
    EXPECT_LE((point.P() - P).norm(), 1e-6 * (1 + P.norm()));
    EXPECT_EQ(count(point.out.inverted), F.determinant() < 0.05 || flatness(F) < 0.05 / std::sqrt(1.005) ? 8 : 0);
    EXPECT_LE(point.acoustic_maximum(), rho * point.out.wave_speed_squared[0] * (1 + 1e-6));
  }
}

TEST(StVenantKirchhoff, UniaxialBiaxialShearAndVolumetricClosedForms) {
  LawDriver point(st_venant_kirchhoff(E, nu, rho));
  for (const double s : {0.6, 0.8, 1.0, 1.3}) {
    const double e = (s * s - 1) / 2;
    point.step(diagonal(s, 1, 1));
    EXPECT_NEAR(point.P()(0, 0), s * (lambda + 2 * mu) * e, 1e-12);
    EXPECT_NEAR(point.P()(1, 1), lambda * e, 1e-12);
    point.step(diagonal(s, s, 1));
    EXPECT_NEAR(point.P()(0, 0), s * (2 * lambda + 2 * mu) * e, 1e-12);
    point.step(diagonal(s, s, s));
    EXPECT_NEAR(point.P()(2, 2), s * (3 * lambda + 2 * mu) * e, 1e-12);
    Matrix3d shear = Matrix3d::Identity(), S = lambda * s * s / 2 * Matrix3d::Identity();
    shear(0, 1) = s;
    S(1, 1) += mu * s * s;
    S(0, 1) = S(1, 0) = mu * s;
    point.step(shear);
    EXPECT_LE((point.P() - shear * S).norm(), 1e-12);
  }
}

TEST(StVenantKirchhoff, Objective) {
  expect_objective(st_venant_kirchhoff(E, nu, rho), 0.3);
}
TEST(StVenantKirchhoff, WaveSpeedBoundsTheAcousticTensor) {
  expect_wave_speed_bound(st_venant_kirchhoff(E, nu, rho), 0.3);
}

// However large the threshold is chosen, material at rest is not crushed, and a column is from J = threshold on.
TEST(ResistCrushing, BeginsWhereAColumnReachesTheThreshold) {
  for (const double threshold : {0.05, 0.3, 0.7, 0.95}) {
    NeoHookean law = neo_hookean(E, nu, rho);
    law.inversion.smallest_J = threshold;
    LawDriver point(law);
    for (const double J : {1.0, threshold * 1.0001, threshold * 0.9999}) {
      point.step(rotation({1, 2, 3}, 0.4) * diagonal(1, 1, J) * rotation({3, -2, 1}, 1.0));
      EXPECT_EQ(count(point.out.inverted), J < threshold ? 8 : 0) << threshold << " " << J;
    }
  }
}

// Squeezed flat while it keeps its volume: the volume ratio says nothing, the smallest stretch does.
TEST(ResistCrushing, NoFiniteWorkMakesAPointFlat) {
  LawDriver point(st_venant_kirchhoff(E, nu, rho));
  double last = 0;
  for (const double s : {0.049, 0.03, 0.01, 0.004, 0.002, 0.0012}) {
    const Matrix3d F =
        rotation({1, 2, 3}, 0.4) * diagonal(1 / std::sqrt(s), s, 1 / std::sqrt(s)) * rotation({3, -2, 1}, 1.0);
    point.step(F);
    EXPECT_EQ(count(point.out.inverted), 8) << s;
    const Matrix3d P = derivative(st_venant_energy, F, 1e-4 * s);
    EXPECT_LE((point.P() - P).norm(), 1e-4 * P.norm()) << s;
    EXPECT_LE(point.acoustic_maximum(), rho * point.out.wave_speed_squared[0] * (1 + 1e-4)) << s;
    const double energy = crushing_energy(F, 0.05);
    EXPECT_GT(energy, last);
    last = energy;
  }
  EXPECT_GT(last, 1000 * (lambda + 2 * mu) * 0.05);
}

// Every mixture of thickness, stretch and shear below the threshold: the time step rests on this bound.
TEST(ResistCrushing, WaveSpeedBoundsTheAcousticTensor) {
  LawDriver point(neo_hookean(E, nu, rho));
  RandomTensors random;
  int crushed = 0;
  for (int i = 0; i < 300; ++i) {
    const Matrix3d F = random.deformation(0.4) * diagonal(1, 1, std::pow(10, -1 - 0.005 * i)) * random.deformation(0.4);
    point.step(F);
    crushed += count(point.out.inverted) == 8;
    EXPECT_LE(point.acoustic_maximum(), rho * point.out.wave_speed_squared[0] * (1 + 1e-4)) << i;
  }
  EXPECT_GT(crushed, 150);
}

TEST(LinearElastic, HookesLawAndItsWaveSpeed) {
  const ElasticMaterial material = isotropic(E, nu, rho);
  LawDriver point{LinearElastic(material)};
  RandomTensors random;
  for (int i = 0; i < 20; ++i) {
    const Matrix3d H = random.tensor(0.3), strain = (H + H.transpose()) / 2;
    point.step(Matrix3d::Identity() + H);
    const Matrix3d P = lambda * strain.trace() * Matrix3d::Identity() + 2 * mu * strain;
    EXPECT_LE((point.P() - P).norm(), 1e-13);
    EXPECT_NEAR(rho * point.out.wave_speed_squared[0], lambda + 2 * mu, 1e-12);
    EXPECT_NEAR(point.out.J[0], (Matrix3d::Identity() + H).determinant(), 1e-14);
  }
  point.step(diagonal(-2, 1, 1));
  EXPECT_EQ(count(point.out.inverted), 0);
}

TEST(LinearElastic, AnisotropicStressFollowsTheMatrix) {
  VoigtMatrix C = isotropic(E, nu, rho).C;
  C(0, 0) *= 3;
  C(1, 5) = C(5, 1) = 0.7;
  LawDriver point{LinearElastic(anisotropic(C, rho))};
  point.step(diagonal(1, 1.01, 1));
  EXPECT_NEAR(point.P()(0, 2), 0.007, 1e-14);
  EXPECT_NEAR(point.P()(2, 0), 0.007, 1e-14);
  EXPECT_NEAR(point.acoustic_maximum(), rho * point.out.wave_speed_squared[0], 1e-6);
}

} // namespace
} // namespace iga::solve
