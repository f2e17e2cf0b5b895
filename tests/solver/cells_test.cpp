// Spaces on cells: copies of functions on either side of a gap that lies within one span.
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/space/light_functions.hpp"
#include "solver/space/locate.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using namespace iga::test;

TrimmedModel two_blocks(int degree) {
  const TriangleMesh mesh =
      transformed(join({box({0, 0, 0}, {20, 20, 14.37}), box({0, 0, 14.38}, {20, 20, 30})}), rotation(13, 9), {});
  PartOptions options;
  options.span_size = 6;
  options.degree = degree;
  options.shift = 0.37;
  return make_part(mesh, options);
}

class CellsOfTwoBlocks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, CellsOfTwoBlocks, testing::Values(1, 2, 3, 4));

TEST_P(CellsOfTwoBlocks, AreSoundAndMoveApart) {
  const TrimmedModel model = two_blocks(GetParam());
  for (const std::string& problem : check(model)) ADD_FAILURE() << problem;
  EXPECT_EQ(count_cells(model).components, 2);
  EXPECT_GT(count_cells(model).split_spans, 0);
  const SolutionSpace space(model, {LightFunctions::DegreeP, 1e-3});
  EXPECT_EQ(separate_bodies(space).count, 2);
}

TEST_P(CellsOfTwoBlocks, LightFunctionsFollowTheirOwnSide) {
  const TrimmedModel model = two_blocks(GetParam());
  const auto part = connected_parts(model);
  std::vector<std::int32_t> part_of_function(model.functions.number.size(), -1);
  for (std::size_t c = 0; c < model.num_cells(); ++c)
    for (const std::int32_t f : model.functions_of(c)) {
      auto& own = part_of_function[static_cast<std::size_t>(f)];
      EXPECT_TRUE(own < 0 || own == part[c]);
      own = part[c];
    }
  const LightFunctionPlan plan = plan_light_functions(model, {LightFunctions::DegreeP, 0.05});
  ASSERT_TRUE(model.unknowns.empty()); // no gap ends: unknowns are functions
  EXPECT_FALSE(plan.slaves.empty());
  for (const Slave& slave : plan.slaves)
    for (const auto& [master, weight] : slave.masters)
      EXPECT_EQ(part_of_function[static_cast<std::size_t>(master)],
                part_of_function[static_cast<std::size_t>(slave.unknown)]);
}

TEST_P(CellsOfTwoBlocks, FunctionsAddUpToOneInEveryCell) {
  const TrimmedModel model = two_blocks(GetParam());
  const SolutionSpace space(model, {LightFunctions::Linear, 0.01});
  SpanShapes shapes;
  for (std::int64_t c = 0; c < space.num_cells(); ++c) {
    evaluate(space, c, cell_parameters(model, c), Shapes::Values, shapes);
    for (Eigen::Index q = 0; q < shapes.values.rows(); ++q) EXPECT_NEAR(shapes.values.row(q).sum(), 1, 1e-10);
  }
}

TEST_P(CellsOfTwoBlocks, PlacesBelongToTheBlockTheyLieIn) {
  const TrimmedModel model = two_blocks(GetParam());
  const auto part = connected_parts(model);
  const Locator locator(model);
  const SurfaceCells surface(model);
  // Every quadrature point of the solid and of its surface finds its own cell.
  for (std::size_t c = 0; c < model.num_cells(); ++c) {
    for (const auto& list : {cell_parameters(model, static_cast<std::int64_t>(c)),
                             surface_parameters(model, static_cast<std::int64_t>(c))})
      for (std::size_t q = 0; q < list.size(); q += 3)
        EXPECT_EQ(part[static_cast<std::size_t>(locator.cell_in_solid({list[q], list[q + 1], list[q + 2]}))], part[c]);
    for (auto q = static_cast<std::size_t>(model.surface.quadrature.offsets[c]);
         q < static_cast<std::size_t>(model.surface.quadrature.offsets[c + 1]); ++q) {
      const double* u = &model.surface.quadrature.parameters[3 * q];
      const auto triangle = static_cast<std::size_t>(model.surface.quadrature.triangle[q]);
      EXPECT_EQ(surface.find(triangle, {u[0], u[1], u[2]}).cell, static_cast<std::int64_t>(c));
    }
  }
  for (const double z : {14.36, 14.39}) {
    const TriangleMesh at = transformed(box({10, 10, z}, {11, 11, 20}), rotation(13, 9), {});
    const LocatedPoint found = locate(model, at.vertices[0], "probe");
    const LocatedPoint far = locate(
        model, transformed(box({10, 10, z < 14.375 ? 3.0 : 27.0}, {11, 11, 28}), rotation(13, 9), {}).vertices[0],
        "probe");
    EXPECT_EQ(part[static_cast<std::size_t>(found.cell)], part[static_cast<std::size_t>(far.cell)]) << z;
  }
}

} // namespace
} // namespace iga::solve
