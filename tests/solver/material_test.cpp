#include "solver/mechanics/material.hpp"

#include "format/model/errors.hpp"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

TEST(ElasticMaterial, WaveSpeedsOfAnIsotropicOne) {
  const double E = 210, nu = 0.3, rho = 7.8e-6, mu = E / (2 * (1 + nu));
  const ElasticMaterial m = isotropic(E, nu, rho);
  EXPECT_NEAR(m.slowest_wave(), std::sqrt(mu / rho), 1e-9 * m.slowest_wave());
  EXPECT_NEAR(m.fastest_wave(), std::sqrt(2 * mu * (1 - nu) / (1 - 2 * nu) / rho), 1e-9 * m.fastest_wave());
}

TEST(ElasticMaterial, UniaxialStressGivesYoungsModulusAndPoissonsRatio) {
  const ElasticMaterial m = isotropic(70, 0.25, 1);
  const Voigt strain = m.C.inverse() * (Voigt() << 7, 0, 0, 0, 0, 0).finished();
  EXPECT_NEAR(strain[0], 0.1, 1e-14);
  EXPECT_NEAR(strain[1], -0.025, 1e-14);
  EXPECT_NEAR(strain[2], -0.025, 1e-14);
  EXPECT_NEAR((m.C * (Voigt() << 0, 0, 0, 0.1, 0, 0).finished())[3], 2.8, 1e-14); // engineering shear
}

TEST(ElasticMaterial, RefusesWhatStoresNoEnergy) {
  EXPECT_THROW(isotropic(0, 0.3, 1), InputError);
  EXPECT_THROW(isotropic(1, 0.5, 1), InputError);
  EXPECT_THROW(isotropic(1, -1, 1), InputError);
  EXPECT_THROW(isotropic(1, 0.3, 0), InputError);
  EXPECT_THROW(isotropic(NAN, 0.3, 1), InputError);
  VoigtMatrix C = VoigtMatrix::Identity();
  C(5, 5) = -1;
  EXPECT_THROW(anisotropic(C, 1), InputError);
  C(5, 5) = 1;
  C(0, 1) = 0.1;
  EXPECT_THROW(anisotropic(C, 1), InputError);
}

TEST(ElasticMaterial, VonMisesOfPlainStates) {
  EXPECT_NEAR(von_mises((Voigt() << 5, 0, 0, 0, 0, 0).finished()), 5, 1e-14);
  EXPECT_NEAR(von_mises((Voigt() << 0, 0, 0, 0, 2, 0).finished()), 2 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(von_mises((Voigt() << 3, 3, 3, 0, 0, 0).finished()), 0, 1e-14);
}

TEST(ElasticMaterial, NumbersWhoseSquaresLeaveDoublesAreRefused) {
  for (const auto& [E, rho] :
       {std::pair{1e308, 1.0}, {1e-308, 1.0}, {1.0, 1e-308}, {1.0, 1e308}, {1e-80, 1e80}, {1e80, 1e-80}}) {
    EXPECT_THROW(isotropic(E, 0.3, rho), InputError) << E << " " << rho;
    EXPECT_THROW(anisotropic(VoigtMatrix::Identity() * E, rho), InputError) << E << " " << rho;
  }
  for (const double unit : {1e-30, 1e30}) EXPECT_NO_THROW(isotropic(unit, 0.3, unit));
  EXPECT_NO_THROW(isotropic(210e9, 0.3, 7800));
}
