// Which rules with few points still hold a part together.
#include "preprocessor/quadrature/trimmed_rules.hpp"
#include "preprocessor/reduce/kept_stiffness.hpp"
#include "preprocessor/reduce/span_reduction.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/fitted_rules.hpp"

#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

PointSet gauss(int n) {
  PointSet points;
  box_rule({n, n, n}, 1, points.x, points.w);
  return points;
}

constexpr Box3 whole{{0, 0, 0}, {1, 1, 1}};

TEST(KeptStiffness, CountsTheFieldsThatPointsCanResist) {
  KeptStiffness quadratic(grid_of(5, 2)), cubic(grid_of(5, 3));
  // Alone: eight points have 48 strains for 75 fields that are no rigid motion; 27 resist all.
  EXPECT_FALSE(quadratic.keeps(whole, {0, 0, 0}, gauss(2), gauss(3)));
  EXPECT_TRUE(quadratic.keeps(whole, {0, 0, 0}, gauss(3), gauss(3)));
  // Beside one rigid span 27 fields are left, beside two in different directions nine, three at a corner.
  EXPECT_TRUE(quadratic.keeps(whole, {-1, 0, 0}, gauss(3), gauss(4)));
  EXPECT_TRUE(quadratic.keeps(whole, {-1, 1, -1}, gauss(1), gauss(3)));
  EXPECT_FALSE(quadratic.keeps(whole, {0, 0, 1}, gauss(1), gauss(3)));
  EXPECT_FALSE(cubic.keeps(whole, {1, 0, 0}, gauss(2), gauss(4)));
  EXPECT_TRUE(cubic.keeps(whole, {1, 0, 0}, gauss(4), gauss(4)));
}

// Two Gauss points through a wall of one span at p = 3: a field that vanishes at both goes unseen.
TEST(KeptStiffness, SeesTheFieldBetweenTheLayers) {
  KeptStiffness cubic(grid_of(5, 3));
  PointSet two, three;
  box_rule({4, 4, 2}, 1, two.x, two.w);
  box_rule({4, 4, 3}, 1, three.x, three.w);
  EXPECT_TRUE(cubic.keeps(whole, {-1, 0, 0}, three, gauss(4)));
  PointSet corner;
  box_rule({2, 2, 2}, 1, corner.x, corner.w);
  EXPECT_FALSE(cubic.keeps(whole, {-1, 0, 0}, corner, gauss(4)));
}

std::int64_t secured(const TriangleMesh& mesh, std::int64_t spans, int degree, bool reduce) {
  const SplineGrid grid = grid_of(spans, degree);
  const Trimming trimming = trim(grid, mesh, {});
  QuadratureOptions options;
  options.moment_degree = {degree, degree, degree};
  TrimmedRules rules(grid, trimming, options);
  if (reduce) rules.reduce(options);
  rules.secure(options);
  return rules.counts().stabilised_spans;
}

TEST(SecureRules, LeavesSolidPartsAlone) {
  const TriangleMesh cube = transformed(box({-1.9, -1.9, -1.9}, {1.9, 1.9, 1.9}), rotation(30, 20), {3.5, 3.4, 3.6});
  EXPECT_LE(secured(cube, 7, 2, true), 3); // of 200: corners that hardly hold anything
  EXPECT_EQ(secured(cube, 7, 2, false), 0);
}

// A box of 2 × 2 × 2 spans, each cut to a corner: products of eight points cannot hold it together at p = 3.
TEST(SecureRules, StrengthensProductsWhereNoSpanIsWhole) {
  const TriangleMesh small = box({1.6, 1.55, 1.7}, {2.5, 2.4, 2.3});
  EXPECT_GT(secured(small, 4, 3, false), 0);
  EXPECT_LE(secured(small, 4, 3, false), 8);
}

} // namespace
} // namespace iga::prep
