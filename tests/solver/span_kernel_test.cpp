// Internal forces of the explicit kernel against the assembled stiffness, closed forms and themselves.
#include "solver/explicit/span_kernel.hpp"

#include "solver/assemble.hpp"
#include "tests/solver/test_law.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;

namespace {

// Interior spans in several blocks, trimmed ones on all sides.
test::BoxCase a_box(std::array<int, 3> p, const Rotation& R = identity_rotation) {
  return {{0, 0, 0}, {8, 4.4, 6}, {20, 11, 12}, p, R, {1.5, 1.3, 2.0}, {6.7, 3.5, 4.3}};
}

Eigen::VectorXd some_vector(Eigen::Index n, double size) {
  Eigen::VectorXd u(n);
  for (Eigen::Index k = 0; k < n; ++k) u[k] = size * std::sin(1.0 + 3.7 * static_cast<double>(k));
  return u;
}

// E^T f of plain functions.
Eigen::VectorXd gather(const SolutionSpace& space, const Eigen::VectorXd& f) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Eigen::VectorXd nodes(space.num_unknowns());
  Eigen::Map<Rows>(nodes.data(), space.num_nodes(), 3).noalias() =
      space.extension().transpose() * Eigen::Map<const Rows>(f.data(), f.size() / 3, 3);
  return nodes;
}

constexpr double lambda = 1.5, mu = 0.8, density = 2;

ElasticMaterial material() {
  return isotropic(mu * (3 * lambda + 2 * mu) / (lambda + mu), lambda / (2 * (lambda + mu)), density);
}

class SpanKernels : public ::testing::TestWithParam<std::array<int, 3>> {};

} // namespace

TEST_P(SpanKernels, SmallDisplacementsGiveTheForcesOfTheStiffness) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  for (const LightFunctions remedy : {LightFunctions::None, LightFunctions::Linear}) {
    const SolutionSpace space(model, {remedy, 0.05});
    const auto K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material());
    const auto kernel = make_internal_forces(space, test::Linear{density, lambda, mu});
    const Eigen::VectorXd u = some_vector(space.num_unknowns(), 1), full = space.expand(u), expected = K * u;
    Eigen::VectorXd f(full.size());
    kernel->evaluate(full.data(), 0, f.data());
    EXPECT_LT((gather(space, f) - expected).norm(), 1e-13 * expected.norm());
    EXPECT_EQ(kernel->plan().num_points, static_cast<std::int64_t>(model.points.weights.size()));
    EXPECT_GT(kernel->plan().num_group_points, 0);
    EXPECT_GT(kernel->plan().num_points, kernel->plan().num_group_points);
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, SpanKernels,
                         ::testing::Values(std::array{1, 1, 1}, std::array{2, 2, 2}, std::array{3, 3, 3},
                                           std::array{4, 4, 4}, std::array{1, 3, 2}));
