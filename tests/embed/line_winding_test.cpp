#include "preprocessor/connectivity/line_winding.hpp"

#include "tests/embed/surfaces.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace iga::prep {
namespace {

using namespace iga::test;

constexpr double sliver = 2e-5;

WindingReport judge(const SplineGrid& grid, const TriangleMesh& mesh) {
  return check_winding(grid, mesh, trim(grid, mesh, {}), sliver);
}

void expect_clean(const WindingReport& r) {
  EXPECT_GT(r.num_lines, 0);
  EXPECT_GT(r.num_crossings, 0);
  EXPECT_EQ(r.bad_lines, 0);
  EXPECT_EQ(r.bad_length, 0);
  EXPECT_EQ(r.worst_winding, 0);
}

TEST(LineWinding, IsZeroOrOneForSoundSolids) {
  for (int degree = 1; degree <= 4; ++degree) {
    const TriangleMesh ball = sphere({0, 0, 0}, 1, 3);
    const WindingReport r = judge(grid_around(ball, 0.2, degree, 0.3), ball);
    expect_clean(r);
    const TriangleMesh cube = transformed(box({0, 0, 0}, {1, 1, 1}), rotation(30, 20), {});
    const WindingReport c = judge(grid_around(cube, 0.11, degree, 0.1), cube);
    expect_clean(c);
    const TriangleMesh aligned = box({0, 0, 0}, {1, 1, 1});
    expect_clean(judge(grid_around(aligned, 0.1, degree), aligned));
  }
}

TEST(LineWinding, SeesOverlappingBodies) {
  const TriangleMesh two = join({box({0, 0, 0}, {1, 1, 1}), box({0.7, 0.6, 0.5}, {1.7, 1.6, 1.5})});
  const WindingReport r = judge(grid_around(two, 0.13, 2, 0.4), two);
  EXPECT_GT(r.bad_lines, 0);
  EXPECT_EQ(r.worst_winding, 2);
  EXPECT_GT(r.bad_length, 0.3);
  EXPECT_GT(r.where[0], 0.7);
  EXPECT_LT(r.where[0], 1.0);
  EXPECT_GT(r.where[2], 0.5);
  EXPECT_LT(r.where[2], 1.0);
}

TEST(LineWinding, TellsACavityFromANestedBody) {
  const TriangleMesh outer = sphere({0, 0, 0}, 1, 3), inner = sphere({0, 0, 0}, 0.5, 3);
  const SplineGrid grid = grid_around(outer, 0.15, 2, 0.2);
  EXPECT_EQ(judge(grid, join({outer, inner})).worst_winding, 2);
  expect_clean(judge(grid, join({outer, flipped(inner)})));
  EXPECT_EQ(judge(grid, flipped(outer)).worst_winding, -1);
}

TEST(LineWinding, SeesAMissingTriangle) {
  TriangleMesh ball = sphere({0, 0, 0}, 1, 2);
  const SplineGrid grid = grid_around(ball, 0.15, 2, 0.2);
  ball.triangles.erase(ball.triangles.begin() + 17);
  ball.region.pop_back();
  EXPECT_GT(judge(grid, ball).bad_lines, 0);
}

TEST(LineWinding, AcceptsTouchingBodies) {
  // With a face in the grid plane and off it; together a bigger box, but each its own body.
  for (const double x : {0.5, 0.537}) {
    const TriangleMesh two = join({box({0.1, 0.1, 0.1}, {x, 0.9, 0.9}), box({x, 0.1, 0.1}, {0.9, 0.9, 0.9})});
    const WindingReport r = judge(SplineGrid({0, 0, 0}, {1, 1, 1}, {10, 10, 10}, {2, 2, 2}), two);
    expect_clean(r);
  }
}

TEST(LineWinding, WorksWithUnequalDegreesAndInARotatedGrid) {
  const TriangleMesh two = join({box({0, 0, 0}, {1, 1, 1}), box({1.05, 0, 0}, {2, 1, 1})});
  const SplineGrid around = grid_around(two, 0.2, 4, 0.3, rotation(20, 40));
  const SplineGrid grid(around.A(), around.B(), around.spans(), {1, 2, 4}, around.rotation());
  const WindingReport r = judge(grid, two);
  expect_clean(r);
}

TEST(LineWinding, DependsNeitherOnScaleNorOnPlace) {
  const TriangleMesh two = join({sphere({0, 0, 0}, 1, 3), sphere({1.5, 0.1, 0.2}, 1, 3)});
  const WindingReport reference = judge(grid_around(two, 0.2, 2, 0.21), two);
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double shift : {0.0, 1e4}) {
      TriangleMesh moved = two;
      for (Point3& v : moved.vertices)
        for (double& c : v) c = scale * (c + shift);
      const WindingReport r = judge(grid_around(moved, 0.2 * scale, 2, 0.21), moved);
      EXPECT_EQ(r.num_crossings, reference.num_crossings);
      EXPECT_EQ(r.bad_lines, reference.bad_lines);
      EXPECT_NEAR(r.bad_length / scale, reference.bad_length, 1e-8 * reference.bad_length);
    }
}

TEST(LineWinding, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh two = join({sphere({0, 0, 0}, 1, 3), sphere({1.5, 0.1, 0.2}, 1, 3)});
  const SplineGrid grid = grid_around(two, 0.2, 2, 0.2);
  const WindingReport many = judge(grid, two);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const WindingReport single = judge(grid, two);
  EXPECT_GT(many.bad_lines, 0);
  EXPECT_EQ(many.bad_lines, single.bad_lines);
  EXPECT_EQ(many.bad_length, single.bad_length);
  EXPECT_EQ(many.where, single.where);
}

TEST(LineWindingParts, FindsSoundPartsSoundAndFlawedOnesFlawed) {
  if (shared_part("valid").empty()) GTEST_SKIP() << "shared STL parts are absent";
  for (const char* name : {"elephant.stl", "busted.STL", "plate_rot_t0.005.stl", "cube_theta0_aligned.stl",
                           "X_Carriage_x1.stl", "torus.STL", "unit_sphere.STL"}) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = read_stl(shared_part(std::string("valid/") + name));
    expect_clean(judge(grid_with(mesh, 15, 2), mesh));
  }
  for (const char* name : {"cubes_overlap.stl", "box.STL", "cube_one_tri_missing.stl"}) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = read_stl(shared_part(std::string("flawed/") + name));
    EXPECT_GT(judge(grid_with(mesh, 15, 2), mesh).bad_lines, 0);
  }
}

} // namespace
} // namespace iga::prep
