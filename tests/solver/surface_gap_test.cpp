// The narrowest gap between bodies of a surface, known by construction.
#include "solver/report/surface_gap.hpp"
#include "tests/support/small_surfaces.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::int32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  a.region.insert(a.region.end(), b.region.begin(), b.region.end());
  return a;
}

TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TEST(SurfaceGap, OfTwoPlatesIsTheirDistance) {
  const TriangleMesh plates = both(test::box_mesh({0, 0, 0}, {100, 60, 2}), test::box_mesh({20, 10, 3}, {70, 90, 5}));
  const auto gap = narrowest_gap(plates, 10);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->width, 1, 1e-12);
  EXPECT_NEAR(gap->from[2], 2, 1e-12);
  EXPECT_NEAR(gap->to[2], 3, 1e-12);
  EXPECT_FALSE(narrowest_gap(plates, 0.9));
}

TEST(SurfaceGap, BetweenEdgesThatPassEachOther) {
  // Upright edges at (1, 1) and (1.3, 1.4).
  const TriangleMesh boxes = both(test::box_mesh({0, 0, 0}, {1, 1, 1}), test::box_mesh({1.3, 1.4, 0.2}, {2, 2, 0.7}));
  const auto gap = narrowest_gap(boxes, 2);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->width, 0.5, 1e-12);
}

TEST(SurfaceGap, DoesNotTakeAWallAroundACavityForOne) {
  const TriangleMesh hollow =
      both(test::box_mesh({0, 0, 0}, {10, 10, 10}), turned_inside_out(test::box_mesh({1, 1, 1}, {9, 9, 9})));
  EXPECT_FALSE(narrowest_gap(hollow, 5));
  // … but the gap around a body in the cavity counts.
  const auto gap = narrowest_gap(both(hollow, test::box_mesh({3, 3, 3}, {7, 7, 7})), 5);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->width, 2, 1e-12);
}

} // namespace
} // namespace iga::solve
