#include "solver/space/solution_space.hpp"

#include "format/model/bspline_basis.hpp"
#include "solver/mechanics/assemble.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

namespace {

// A box whose corner lies just inside a span: light functions on three sides.
test::BoxCase slightly_cut(int p, double depth = 0.02, const Rotation& R = identity_rotation) {
  const double margin = p;
  const Index3 spans{7 + 2 * p, 6 + 2 * p, 6 + 2 * p};
  return {{0, 0, 0},
          {static_cast<double>(spans[0]), static_cast<double>(spans[1]), static_cast<double>(spans[2])},
          spans,
          {p, p, p},
          R,
          {margin + 1 - depth, margin + 1 - depth, margin + 0.5},
          {margin + 6.3, margin + 5 + depth, margin + 5}};
}

class SolutionSpaceDegrees : public ::testing::TestWithParam<int> {};

} // namespace

TEST_P(SolutionSpaceDegrees, PlainShapeFunctionsAreTheBsplinesOfTheGrid) {
  const int p = GetParam();
  // no margin: open ends, where the recursion for equal knots does not hold
  const TrimmedModel model =
      test::make_box_model({{0, 0, 0}, {4, 4, 4}, {4, 4, 4}, {p, p, p}, identity_rotation, {0, 0, 0}, {4, 4, 3.5}});
  const SolutionSpace space(model, {});
  SpanShapes shapes;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const Index3 ijk = model.grid.span_index(model.cells.span[static_cast<std::size_t>(a)]);
    const auto u = cell_parameters(model, a);
    evaluate(space, a, u, Shapes::Both, shapes);
    const std::size_t n = static_cast<std::size_t>(p) + 1;
    std::vector<double> N[3], D[3];
    for (std::size_t d = 0; d < 3; ++d) {
      N[d].resize(n);
      D[d].resize(n);
      evaluate_basis(model.grid.knots(static_cast<int>(d)), ijk[d], u[d], N[d]);
      evaluate_basis_derivatives(model.grid.knots(static_cast<int>(d)), ijk[d], u[d], D[d]);
    }
    for (std::size_t i = 0; i < n * n * n; ++i) {
      const std::size_t x = i % n, y = i / n % n, z = i / n / n;
      const auto column = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(shapes.values(0, column), N[0][x] * N[1][y] * N[2][z], 1e-14);
      EXPECT_NEAR(shapes.gradients(0, 3 * column), D[0][x] * N[1][y] * N[2][z], 1e-13);
      EXPECT_NEAR(shapes.gradients(0, 3 * column + 1), N[0][x] * D[1][y] * N[2][z], 1e-13);
      EXPECT_NEAR(shapes.gradients(0, 3 * column + 2), N[0][x] * N[1][y] * D[2][z], 1e-13);
    }
  }
}

TEST_P(SolutionSpaceDegrees, ExtensionsReproduceLinearFieldsEverywhere) {
  const int p = GetParam();
  const TrimmedModel model = test::make_box_model(slightly_cut(p, 0.02, test::some_rotation(0.4)));
  const Eigen::Matrix3d G = (Eigen::Matrix3d() << 0.1, -0.2, 0.3, 0.4, 0.5, -0.6, 0.7, 0.8, 0.9).finished();
  const Eigen::Vector3d c(1, -2, 3);
  for (const auto remedy : {LightFunctions::None, LightFunctions::Linear, LightFunctions::DegreeP}) {
    const SolutionSpace space(model, {remedy, 0.03});
    EXPECT_EQ(space.num_light() > 0, remedy != LightFunctions::None);
    const auto points = space.node_points();
    SpanShapes shapes;
    for (std::int64_t a = 0; a < space.num_cells(); ++a) {
      const auto u = cell_parameters(model, a);
      evaluate(space, a, u, Shapes::Both, shapes);
      const auto nodes = space.nodes(a);
      for (std::size_t q = 0; q < u.size() / 3; ++q) {
        Eigen::Vector3d value = Eigen::Vector3d::Zero();
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          const Eigen::Vector3d coefficient = G * points.row(nodes[i]).transpose() + c;
          const auto column = static_cast<Eigen::Index>(i), row = static_cast<Eigen::Index>(q);
          value += shapes.values(row, column) * coefficient;
          gradient += coefficient * shapes.gradients.block<1, 3>(row, 3 * column);
        }
        const Point3 x = model.grid.to_position({u[3 * q], u[3 * q + 1], u[3 * q + 2]});
        EXPECT_LT((value - G * Eigen::Vector3d(x[0], x[1], x[2]) - c).norm(), 1e-10);
        EXPECT_LT((gradient - G).norm(), 1e-10);
      }
    }
  }
}

TEST_P(SolutionSpaceDegrees, DegreePExtensionReproducesPolynomialsOfTheDegree) {
  const int p = GetParam();
  const TrimmedModel model = test::make_box_model(slightly_cut(p));
  const SolutionSpace space(model, {LightFunctions::DegreeP, 0.03});
  ASSERT_GT(space.num_light(), 0);
  // coefficient of (u v)^p: the blossom, a product of the inner knots of the function
  const auto coefficient = [&](std::int64_t f) {
    const Index3 i = model.grid.function_index(model.functions.number[static_cast<std::size_t>(f)]);
    double product = 1;
    for (std::size_t d = 0; d < 2; ++d)
      for (std::int64_t k = 1; k <= p; ++k)
        product *= model.grid.knots(static_cast<int>(d)).values()[static_cast<std::size_t>(i[d] + k)] / 10;
    return product;
  };
  Eigen::VectorXd nodes(space.num_nodes());
  for (Eigen::Index n = 0; n < nodes.size(); ++n)
    nodes[n] = coefficient(space.node_unknowns()[static_cast<std::size_t>(n)]);
  const Eigen::VectorXd all = space.extension() * nodes;
  for (Eigen::Index f = 0; f < all.size(); ++f) EXPECT_NEAR(all[f], coefficient(f), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Degrees, SolutionSpaceDegrees, ::testing::Values(1, 2, 3, 4));

TEST(SolutionSpace, RemovedFunctionsAreGoneFromEverySpan) {
  const TrimmedModel model = test::make_box_model(slightly_cut(2));
  const SolutionSpace all(model, {}), space(model, {LightFunctions::Remove, 0.03});
  EXPECT_EQ(all.num_nodes(), space.num_nodes() + space.num_light());
  const Eigen::VectorXd expanded = space.expand(Eigen::VectorXd::Ones(space.num_unknowns()));
  for (std::size_t f = 0; f < model.functions.number.size(); ++f)
    EXPECT_EQ(expanded[3 * static_cast<Eigen::Index>(f)], model.functions.mass_fraction[f] < 0.03 ? 0.0 : 1.0);
}

TEST(SolutionSpace, ThinPartLowersItsThresholdAndSaysSo) {
  // a plate a hundredth of a span thick: every function is light
  const TrimmedModel model = test::make_box_model(
      {{0, 0, 0}, {10, 10, 6}, {10, 10, 6}, {2, 2, 2}, identity_rotation, {2.1, 2.1, 3.3}, {7.9, 7.9, 3.31}});
  const SolutionSpace space(model, {LightFunctions::Linear, 0.05});
  ASSERT_EQ(space.warnings().size(), 1u);
  EXPECT_NE(space.warnings()[0].find("too thin"), std::string::npos);
  EXPECT_GT(space.num_nodes(), 0);
}

TEST(SolutionSpace, SpeckInTheCornerOfASpanIsFilledWithFictitiousMaterial) {
  // every function sees less than 1e-9 of its volume
  const TrimmedModel model = test::make_box_model(
      {{0, 0, 0}, {7, 7, 7}, {7, 7, 7}, {2, 2, 2}, identity_rotation, {3.4, 3.4, 3.4}, {3.4005, 3.4005, 3.4005}});
  const SolutionSpace space(model, {LightFunctions::Linear, 0.05});
  ASSERT_EQ(space.warnings().size(), 1u);
  EXPECT_NE(space.warnings()[0].find("fictitious"), std::string::npos);
  EXPECT_NEAR(lumped_mass(space, 2).sum(), 2 * (1.25e-10 + 1e-3), 1e-14); // a thousandth of the one span
}
