// Bodies that share functions are counted as one group.
#include "preprocessor/connectivity/joined_bodies.hpp"

#include "tests/embed/surfaces.hpp"

#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

JoinedBodies count(const TriangleMesh& mesh, double size, int degree, double shift = 0) {
  const SplineGrid grid = grid_around(mesh, size, degree, shift);
  return find_joined_bodies(grid, mesh, trim(grid, mesh, {}));
}

TEST(JoinedBodies, PlatesThinnerThanASpanWithAGap) {
  const TriangleMesh plates = join({box({0, 0, 0}, {100, 60, 2}), box({0, 0, 3}, {100, 60, 5})});
  for (const double shift : {0.0, 0.37}) {
    const JoinedBodies coarse = count(plates, 5, 2, shift), fine = count(plates, 0.25, 1, shift);
    EXPECT_EQ(coarse.bodies, 2);
    EXPECT_EQ(coarse.groups, 1);
    EXPECT_EQ(fine.bodies, 2);
    EXPECT_EQ(fine.groups, 2);
  }
}

TEST(JoinedBodies, CavitiesAreNoBodies) {
  const TriangleMesh hollow = join({box({0, 0, 0}, {4, 4, 4}), flipped(box({1, 1, 1}, {3, 3, 3}))});
  const JoinedBodies one = count(hollow, 1, 2);
  EXPECT_EQ(one.bodies, 1);
  EXPECT_EQ(one.groups, 1);
}

// Faces in grid planes: the pieces of the lower box's top belong to the empty span above it.
TEST(JoinedBodies, BodiesThatNoFunctionJoinsStaySeparate) {
  const TriangleMesh boxes = join({box({0, 0, 0}, {4, 4, 4}), box({0, 0, 6}, {4, 4, 10})});
  EXPECT_EQ(count(boxes, 1, 2).groups, 2);
  EXPECT_EQ(count(boxes, 1, 3).groups, 1);
}

} // namespace
} // namespace iga::prep
