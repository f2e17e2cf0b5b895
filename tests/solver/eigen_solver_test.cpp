// Lowest modes against closed forms, dense eigenvalues and what must hold of every eigenpair.
#include "solver/analysis/eigen_solver.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/eigen_support.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const ElasticMaterial unit_shear = isotropic(2.6, 0.3, 1); // mu = 1

// Omega of the free cube of edge 1 (nu = 0.3, c_S = 1), ascending with multiplicity (numerics of the project, 11.6).
constexpr double free_cube[]{2.85605, 2.85605, 3.84597, 3.84597, 3.84597, 3.91125, 3.91125,
                             3.91125, 4.44288, 4.44288, 4.44288, 4.57278, 4.57278, 4.57278};

void expect_sound(const ModeSet& set, const EigenProblem& problem, double orthogonality = 1e-9) {
  const Eigen::Index count = set.lambda.size();
  ASSERT_EQ(count, set.rigid + set.mechanisms + set.elastic);
  ASSERT_EQ(set.vectors.cols(), count);
  MatrixXd MX(set.vectors.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) MX.col(k) = *problem.mass * VectorXd(set.vectors.col(k));
  const MatrixXd G = set.vectors.transpose() * MX;
  EXPECT_LT((G - MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(), orthogonality);
  EXPECT_LT(set.residual.maxCoeff(), residual_limit);
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::Index largest = 0;
    set.vectors.col(k).cwiseAbs().maxCoeff(&largest);
    EXPECT_GT(set.vectors.col(k).maxCoeff(), (1 - 1e-5) * std::abs(set.vectors(largest, k)));
  }
}

VectorXd elastic(const ModeSet& set) {
  return set.lambda.tail(set.elastic).cwiseSqrt();
}

VectorXd dense_omega(const test::System& s) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> dense(test::dense(s.K, s.K.size()),
                                                                 test::dense(s.M, s.K.size()), Eigen::EigenvaluesOnly);
  return dense.eigenvalues().cwiseMax(0).cwiseSqrt();
}

TrimmedModel cube(int spans, int p, double cut = 0.6) {
  return test::make_box_model(test::box_in_grid({1, 1, 1}, {spans, spans, spans}, p, cut));
}

} // namespace

TEST(LowestModes, FreeCubeHasItsFrequenciesAndMultiplicities) {
  for (const int block : {4, 1}) {
    const test::System s(cube(5, 3), unit_shear);
    const EigenProblem problem = s.problem();
    const ModeSet set = lowest_modes(problem, {.modes = 14, .sturm = true, .block = block});
    EXPECT_EQ(set.rigid, 6);
    EXPECT_EQ(set.mechanisms, 0);
    ASSERT_EQ(set.elastic, 14);
    const VectorXd omega = elastic(set);
    for (Eigen::Index k = 0; k < 14; ++k) EXPECT_NEAR(omega[k], free_cube[k], 3e-4 * free_cube[k]) << k;
    ASSERT_TRUE(set.sturm);
    EXPECT_EQ(set.sturm->expected, set.sturm->found);
    EXPECT_TRUE(set.warnings.empty());
    expect_sound(set, problem);
  }
}

TEST(LowestModes, RigidModesAreFarBelowTheElasticOnes) {
  for (int p = 1; p <= 4; ++p) {
    const test::System s(cube(3, p), unit_shear);
    const ModeSet set = lowest_modes(s.problem(), {.modes = 1, .sturm = true});
    ASSERT_EQ(set.rigid, 6) << "degree " << p;
    EXPECT_LT(set.lambda.head(6).cwiseAbs().maxCoeff(), 1e-8 * set.lambda[6]);
  }
}

TEST(LowestModes, AModeCutOutOfItsMultipletIsReported) {
  const test::System s(cube(4, 2, 1), unit_shear);
  const ModeSet set = lowest_modes(s.problem(), {.modes = 3, .sturm = true});
  EXPECT_EQ(set.elastic, 3);
  ASSERT_EQ(set.warnings.size(), 1u);
  EXPECT_NE(set.warnings[0].find("--modes 5"), std::string::npos) << set.warnings[0];
  EXPECT_EQ(set.sturm->found, 6 + 5); // the count stands behind the multiplet
}

TEST(LowestModes, AgreeWithDenseEigenvaluesForEveryMass) {
  for (const MassType type : {MassType::Consistent, MassType::Lumped, MassType::TwoPass, MassType::ThreePass}) {
    const test::System s(test::make_box_model(test::box_in_grid({1.3, 1, 0.8}, {2, 2, 2}, 2, 0.4)), unit_shear, type);
    const EigenProblem problem = s.problem();
    const ModeSet set = lowest_modes(problem, {.modes = 8, .sturm = true});
    const VectorXd exact = dense_omega(s), omega = elastic(set);
    ASSERT_EQ(set.elastic, 8);
    for (Eigen::Index k = 0; k < 8; ++k)
      EXPECT_NEAR(omega[k], exact[6 + k], 1e-9 * exact[6 + k]) << "mass " << static_cast<int>(type);
    EXPECT_EQ(set.sturm.has_value(), type == MassType::Consistent || type == MassType::Lumped);
    EXPECT_EQ(set.searched_again, !set.sturm);
    expect_sound(set, problem);
  }
}

TEST(LowestModes, RodWithoutPoissonEffectSoundsAsItShould) {
  // nu = 0: omega_k = k pi c / L of the free rod, c = sqrt(E / rho), among bending and torsion. Lumping lowers it by
  // (p + 1) (k h)² / 24. Across the rod one linear span, where no function is light.
  const double L = 8, h = L / 15.5;
  const ElasticMaterial material = isotropic(4, 0, 1);
  const test::BoxCase box = test::box_in_grid({L, 0.6, 0.6}, {16, 1, 1}, {2, 1, 1}, {0.5, 1, 1});
  const double exact = std::numbers::pi * 2 / L, k = std::numbers::pi / L;
  const auto nearest = [&](MassType type) {
    const test::System s(test::make_box_model(box), material, type);
    const ModeSet set = lowest_modes(s.problem(), {.modes = 16, .sturm = {}});
    // The longitudinal mode moves the ends along x and nothing across: choose by its share along the rod.
    double best = 0, share = 0.9;
    for (Eigen::Index m = set.rigid; m < set.lambda.size(); ++m) {
      double along = 0;
      const VectorXd Mx = s.M * VectorXd(set.vectors.col(m));
      for (Eigen::Index i = 0; i < Mx.size(); i += 3) along += Mx[i] * set.vectors(i, m);
      if (along > share && std::abs(std::sqrt(set.lambda[m]) / exact - 1) < 0.1) {
        share = along;
        best = std::sqrt(set.lambda[m]);
      }
    }
    return best / exact - 1;
  };
  EXPECT_NEAR(nearest(MassType::Consistent), 0, 1e-5);
  EXPECT_NEAR(nearest(MassType::Lumped), -3 * std::pow(k * h, 2) / 24, 0.15 * 3 * std::pow(k * h, 2) / 24);
  EXPECT_LT(std::abs(nearest(MassType::TwoPass)), 2 * std::pow(3 * std::pow(k * h, 2) / 24, 2) * 4);
}

TEST(LowestModes, TwoBodiesHaveTwelveRigidModes) {
  const test::System s(test::make_two_boxes(), unit_shear);
  ASSERT_EQ(separate_bodies(s.K.pattern()).count, 2);
  const EigenProblem problem = s.problem();
  const ModeSet set = lowest_modes(problem, {.modes = 4, .sturm = true});
  EXPECT_EQ(set.rigid, 12);
  ASSERT_EQ(set.elastic, 4);
  const VectorXd omega = elastic(set);
  EXPECT_NEAR(omega[0], omega[1], 1e-9); // the boxes are equal: every mode comes twice
  EXPECT_NEAR(omega[2], omega[3], 1e-9);
  expect_sound(set, problem);
}

TEST(LowestModes, TheCountCatchesAMissingModeAndItIsFound) {
  const test::System s(cube(4, 2), unit_shear);
  EigenProblem problem = s.problem();
  const ModeSet whole = lowest_modes(problem, {.modes = 8, .sturm = true});
  for (const bool sturm : {true, false}) {
    problem.known.resize(s.K.size(), 11);
    // All but the second of the cube's pair; more of them, so that eight are left behind the first gap.
    const ModeSet more = lowest_modes(s.problem(), {.modes = 12, .sturm = true});
    problem.known << more.vectors.col(6), more.vectors.rightCols(10);
    const ModeSet mended = lowest_modes(problem, {.modes = 8, .sturm = sturm});
    ASSERT_EQ(mended.elastic, 8);
    for (Eigen::Index k = 0; k < 8; ++k) EXPECT_NEAR(elastic(mended)[k], elastic(whole)[k], 1e-10);
    const bool again = std::any_of(mended.timings.begin(), mended.timings.end(),
                                   [](const auto& t) { return t.first == "Lanczos again"; });
    EXPECT_TRUE(again);
    expect_sound(mended, problem);
  }
}

TEST(LowestModes, ConstraintsAreObeyedAndLeaveTheRigidMotionsTheyDoNotReach) {
  const test::System s(cube(3, 2), unit_shear);
  const std::int64_t n = s.K.size();
  const auto points = s.space.node_points();
  // Functions left of x = 0 slide on a plane (u_x = 0); three motions stay rigid: along y, along z, about x.
  std::vector<std::int64_t> held;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (points(i, 0) < 1e-9) held.push_back(3 * i);
  for (const bool redundant : {false, true}) {
    ConstraintMatrix C(static_cast<Eigen::Index>(held.size()) + redundant, n);
    for (std::size_t r = 0; r < held.size(); ++r) C.insert(static_cast<Eigen::Index>(r), held[r]) = 2;
    if (redundant) {
      C.insert(static_cast<Eigen::Index>(held.size()), held[0]) = 1;
      C.insert(static_cast<Eigen::Index>(held.size()), held[1]) = -1;
    }
    C.makeCompressed();
    EigenProblem problem = s.problem();
    problem.constraints = &C;
    const ModeSet set = lowest_modes(problem, {.modes = 6, .sturm = true});
    EXPECT_EQ(set.rigid, 3);
    ASSERT_EQ(set.elastic, 6);
    EXPECT_LT((C * set.vectors).cwiseAbs().maxCoeff(), 1e-9 * set.vectors.cwiseAbs().maxCoeff());
    expect_sound(set, problem);
    // Dense: held unknowns taken out.
    MatrixXd K = test::dense(s.K, n), M = test::dense(s.M, n);
    for (const auto i : held) {
      K.row(i).setZero();
      K.col(i).setZero();
      M.row(i).setZero();
      M.col(i).setZero();
      K(i, i) = 1e4;
      M(i, i) = 1;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> dense(K, M, Eigen::EigenvaluesOnly);
    for (Eigen::Index k = 0; k < 6; ++k)
      EXPECT_NEAR(set.lambda[3 + k], dense.eigenvalues()[3 + k], 1e-8 * dense.eigenvalues()[3 + k]);
  }
}

TEST(LowestModes, MoreModesThanUnknownsAreRefused) {
  const test::System s(cube(1, 1, 1), unit_shear); // 8 functions, 24 unknowns, 6 rigid motions
  ASSERT_EQ(s.K.size(), 24);
  EXPECT_THROW(lowest_modes(s.problem(), {.modes = 19, .sturm = {}}), InputError);
  EXPECT_THROW(lowest_modes(s.problem(), {.modes = 0, .sturm = {}}), InputError);
  const ModeSet all = lowest_modes(s.problem(), {.modes = 18, .sturm = true});
  const VectorXd exact = dense_omega(s);
  ASSERT_EQ(all.elastic, 18);
  for (Eigen::Index k = 0; k < 18; ++k) EXPECT_NEAR(elastic(all)[k], exact[6 + k], 1e-9 * exact[6 + k]);
}

TEST(LowestModes, ManyModesComeFromTheDenseSolverAndAgreeWithLanczos) {
  for (const MassType type : {MassType::Consistent, MassType::Lumped}) {
    const test::System s(cube(4, 2, 0.7), unit_shear, type); // 6³ functions
    ASSERT_EQ(s.K.size(), 648);
    const ModeSet dense = lowest_modes(s.problem(), {.modes = 200, .sturm = true});
    const ModeSet lanczos = lowest_modes(s.problem(), {.modes = 63, .sturm = true});
    const auto used = [](const ModeSet& set, const char* stage) {
      return std::any_of(set.timings.begin(), set.timings.end(), [&](const auto& t) { return t.first == stage; });
    };
    EXPECT_TRUE(used(dense, "dense solver"));
    EXPECT_FALSE(used(lanczos, "dense solver"));
    ASSERT_EQ(dense.elastic, 200);
    EXPECT_EQ(dense.rigid, 6);
    EXPECT_EQ(dense.sturm->found, dense.sturm->expected);
    for (Eigen::Index k = 0; k < 63; ++k)
      EXPECT_NEAR(elastic(dense)[k], elastic(lanczos)[k], 1e-8 * elastic(lanczos)[k]) << k;
    const VectorXd exact = dense_omega(s);
    for (Eigen::Index k = 0; k < 200; ++k) EXPECT_NEAR(elastic(dense)[k], exact[6 + k], 1e-8 * exact[6 + k]) << k;
  }
}

TEST(LowestModes, APlateMuchThinnerThanItsSpansBendsAsItShould) {
  // A hundredth of a span thick, in the middle of one layer of spans: functions across it are nearly dependent. Free
  // square plate, nu = 0.3: ω a² √(ρ t / D) = 13.468, 19.596, 24.270, 34.801, 34.801 (Leissa 1969, NASA SP-160, FFFF).
  constexpr double t = 0.0025, rest = (0.25 - t) / 2;
  const double plate = t * std::sqrt(2.6 / (12 * (1 - 0.3 * 0.3)));
  for (const int p : {2, 3, 4}) {
    test::BoxCase box = test::box_in_grid({1, 1, 0.25}, {4, 4, 1}, p);
    box.lower[2] += rest;
    box.upper[2] = box.lower[2] + t;
    const test::System s(test::make_box_model(box), unit_shear, MassType::Consistent, {LightFunctions::DegreeP, 1e-3});
    EigenProblem problem = s.problem();
    const ModeSet set = lowest_modes(problem, {.modes = 5, .sturm = true});
    EXPECT_EQ(set.rigid, 6);
    EXPECT_EQ(set.mechanisms, 0);
    const double exact[]{13.468, 19.596, 24.270, 34.801, 34.801};
    // From above, as a Ritz value comes: four spans of low degree lock in the higher modes.
    const double too_stiff = p == 2 ? 0.5 : p == 3 ? 0.2 : 0.05;
    for (Eigen::Index k = 0; k < 5; ++k) {
      EXPECT_GT(elastic(set)[k], 0.995 * plate * exact[k]) << "degree " << p << ", mode " << k + 1;
      EXPECT_LT(elastic(set)[k], (1 + too_stiff) * plate * exact[k]) << "degree " << p << ", mode " << k + 1;
    }
  }
}

TEST(LowestModes, AMechanismIsNamed) {
  // Motions without stiffness that nobody wrote down: the rigid ones of a cube, kept secret.
  const test::System s(cube(3, 2), unit_shear);
  EigenProblem problem = s.problem();
  problem.motions.resize(s.K.size(), 0);
  const ModeSet set = lowest_modes(problem, {.modes = 4, .sturm = true});
  EXPECT_EQ(set.rigid, 0);
  EXPECT_EQ(set.mechanisms, 6);
  EXPECT_EQ(set.elastic, 4);
  EXPECT_EQ(set.kind[0], ModeKind::Mechanism);
  EXPECT_FALSE(set.warnings.empty());
}
