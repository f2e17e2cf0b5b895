#include "solver/mechanics/assemble.hpp"

#include "solver/mechanics/mass_operator.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;

namespace {

test::BoxCase a_box(int p, const Rotation& R = identity_rotation) {
  return {{0, 0, 0}, {5, 4.4, 6}, {10, 11, 12}, {p, p, p}, R, {1.2, 1.3, 2.0}, {4.1, 3.5, 4.3}};
}

VoigtMatrix some_stiffness() { // positive definite, no symmetry
  VoigtMatrix A;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) A(i, j) = std::sin(1 + 5 * i + 3 * j);
  return A * A.transpose() + 0.5 * VoigtMatrix::Identity();
}

Eigen::MatrixXd dense(const StiffnessMatrix& K) {
  Eigen::MatrixXd D(K.size(), K.size());
  for (Eigen::Index i = 0; i < K.size(); ++i) D.col(i) = K * Eigen::VectorXd::Unit(K.size(), i);
  return D;
}

Eigen::VectorXd linear_field(const SolutionSpace& space, const Eigen::Matrix3d& G) {
  Eigen::VectorXd u(space.num_unknowns());
  const auto points = space.node_points();
  for (Eigen::Index n = 0; n < points.rows(); ++n) u.segment<3>(3 * n) = G * points.row(n).transpose();
  return u;
}

struct Case {
  int p;
  LightFunctions remedy;
  bool isotropic;
};

class Assembly : public ::testing::TestWithParam<Case> {};

} // namespace

TEST_P(Assembly, LinearFieldsStoreTheEnergyOfTheirStrain) {
  const auto& [p, remedy, is_isotropic] = GetParam();
  const TrimmedModel model = test::make_box_model(a_box(p, test::some_rotation(0.7)));
  const ElasticMaterial material = is_isotropic ? isotropic(3, 0.3, 2) : anisotropic(some_stiffness(), 2);
  const SolutionSpace space(model, {remedy, 0.01});
  const auto connectivity = std::make_shared<const Connectivity>(space);
  const StiffnessMatrix K = assemble_stiffness(space, connectivity, material);
  const double volume = 2.9 * 2.2 * 2.3;
  const Eigen::Matrix3d G = (Eigen::Matrix3d() << 0.1, -0.2, 0.3, 0.4, 0.5, -0.6, 0.7, 0.8, 0.9).finished();
  const Voigt strain =
      (Voigt() << G(0, 0), G(1, 1), G(2, 2), G(0, 1) + G(1, 0), G(1, 2) + G(2, 1), G(2, 0) + G(0, 2)).finished();
  const Eigen::VectorXd u = linear_field(space, G);
  EXPECT_NEAR(u.dot(K * u) / (volume * strain.dot(material.C * strain)), 1, 1e-11);
  // rigid motions store none
  const Eigen::VectorXd r = linear_field(space, G - G.transpose());
  EXPECT_LT((K * r).norm(), 1e-11 * K.diagonal().norm() * r.lpNorm<Eigen::Infinity>());
}

TEST_P(Assembly, MassIsDensityTimesVolumeAndItsRowSumsAreTheLumpedMass) {
  const auto& [p, remedy, is_isotropic] = GetParam();
  const TrimmedModel model = test::make_box_model(a_box(p));
  const SolutionSpace space(model, {remedy, 0.01});
  const auto connectivity = std::make_shared<const Connectivity>(space);
  const MassMatrix M = assemble_mass(space, connectivity, 2);
  const Eigen::VectorXd lumped = lumped_mass(space, 2);
  EXPECT_NEAR(lumped.sum(), 2 * 2.9 * 2.2 * 2.3, 1e-11);
  EXPECT_LT((M.row_sums() - lumped).cwiseAbs().maxCoeff(), 1e-12 * lumped.maxCoeff());
  // ∫ ρ x² dV from the coefficients of x
  const Eigen::VectorXd x = linear_field(space, Eigen::Vector3d(1, 0, 0).asDiagonal());
  EXPECT_NEAR(x.dot(M * x), 2 * 2.2 * 2.3 * (4.1 * 4.1 * 4.1 - 1.2 * 1.2 * 1.2) / 3, 1e-10);
}

TEST_P(Assembly, LumpedMassIsPositiveAndComplete) {
  const auto& [p, remedy, is_isotropic] = GetParam();
  const TrimmedModel model = test::make_box_model(a_box(p));
  for (const double threshold : {0.01, 0.05, 0.2}) {
    const SolutionSpace space(model, {remedy, threshold});
    const Eigen::VectorXd lumped = spare_masses(space, 2).masses;
    EXPECT_GT(lumped.minCoeff(), 0) << threshold;
    EXPECT_NEAR(lumped.sum(), 2 * 2.9 * 2.2 * 2.3, 1e-11);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Assembly,
                         ::testing::Values(Case{1, LightFunctions::None, true}, Case{2, LightFunctions::None, true},
                                           Case{3, LightFunctions::None, true}, Case{4, LightFunctions::None, true},
                                           Case{2, LightFunctions::None, false}, Case{3, LightFunctions::None, false},
                                           Case{2, LightFunctions::Linear, true},
                                           Case{3, LightFunctions::DegreeP, true},
                                           Case{4, LightFunctions::DegreeP, false}));

TEST(Assembly, EveryEntryIsTheIntegralOfItsTwoFunctions) {
  const TrimmedModel model = test::make_box_model(
      {{0, 0, 0}, {5, 5, 5}, {5, 5, 5}, {2, 2, 2}, identity_rotation, {1.3, 1, 1.2}, {4, 3.7, 3.2}});
  const SolutionSpace space(model, {LightFunctions::Linear, 0.02});
  ASSERT_GT(space.num_light(), 0);
  const ElasticMaterial material = anisotropic(some_stiffness(), 1);
  const auto connectivity = std::make_shared<const Connectivity>(space);
  Eigen::MatrixXd reference = Eigen::MatrixXd::Zero(space.num_unknowns(), space.num_unknowns());
  SpanShapes shapes;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    evaluate(space, a, cell_parameters(model, a), Shapes::Gradients, shapes);
    const auto nodes = space.nodes(a);
    const auto w = cell_weights(model, a);
    for (std::size_t q = 0; q < w.size(); ++q) {
      Eigen::MatrixXd B = Eigen::MatrixXd::Zero(6, space.num_unknowns());
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Eigen::RowVector3d g =
            shapes.gradients.block<1, 3>(static_cast<Eigen::Index>(q), 3 * static_cast<Eigen::Index>(i));
        const Eigen::Index c = 3 * nodes[i];
        B(0, c) = B(3, c + 1) = B(5, c + 2) = g[0];
        B(1, c + 1) = B(3, c) = B(4, c + 2) = g[1];
        B(2, c + 2) = B(4, c + 1) = B(5, c) = g[2];
      }
      reference += w[q] * B.transpose() * material.C * B;
    }
  }
  const Eigen::MatrixXd K = dense(assemble_stiffness(space, connectivity, material));
  EXPECT_LT((K - reference).cwiseAbs().maxCoeff(), 1e-12 * reference.cwiseAbs().maxCoeff());
  EXPECT_EQ(K, K.transpose());
}

TEST(Assembly, SameBitsForAnyNumberOfThreads) {
  const TrimmedModel model = test::make_box_model(a_box(2));
  const SolutionSpace space(model, {LightFunctions::Linear, 0.02});
  const auto connectivity = std::make_shared<const Connectivity>(space);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const StiffnessMatrix K = assemble_stiffness(space, connectivity, isotropic(1, 0.3, 1));
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(K.size(), -1, 2);
    return std::pair(std::vector(K.values().begin(), K.values().end()), Eigen::VectorXd(K * x));
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(Assembly, BodyForceSumsToForceTimesVolume) {
  const TrimmedModel model = test::make_box_model(a_box(2));
  const SolutionSpace space(model, {LightFunctions::DegreeP, 1e-3});
  const Eigen::VectorXd f = body_force(space, {0, 0, -9.81});
  EXPECT_NEAR(f.sum(), -9.81 * 2.9 * 2.2 * 2.3, 1e-10);
}
