// No rule holds a point outside the solid, its weights are positive and its moments exact. A bounded share of what
// points_inside_tool does with any number of solids.
#include "tests/quadrature/random_solids.hpp"

#include <gtest/gtest.h>

namespace iga::test {
namespace {

void expect_inside(std::uint64_t seed, const std::string& rule) {
  const RandomSolid solid = random_solid(seed);
  const OutsidePoints found = find_outside_points(solid, rule);
  EXPECT_GT(found.points, 0) << solid.name;
  EXPECT_EQ(found.outside, 0) << solid.name << ": up to " << found.deepest << " spans";
  EXPECT_GT(found.least_weight, 0) << solid.name;
  EXPECT_LE(found.moment_residual, 1e-10) << solid.name;
  EXPECT_LE(found.volume_error, 1e-9) << solid.name;
}

#ifdef __SANITIZE_ADDRESS__
constexpr bool is_sanitized = true; // thirty times slower
#else
constexpr bool is_sanitized = false;
#endif

// Seeds on which lines that graze thin walls once gave candidates outside.
TEST(PointsInside, WallsThatLinesGraze) {
  for (const std::uint64_t seed : {19, 24, 57}) {
    if (is_sanitized && random_solid(seed).degree > 2) continue;
    expect_inside(seed, "nnls");
    if (seed != 19 && !is_sanitized) expect_inside(seed, "minimal");
  }
}

TEST(PointsInside, RandomTubesPlatesAndShells) {
  for (std::uint64_t seed = 1000; seed < (is_sanitized ? 1008 : 1024); ++seed) {
    const int degree = random_solid(seed).degree;
    if (degree <= (is_sanitized ? 2 : 3)) expect_inside(seed, "nnls");
    if (degree <= (is_sanitized ? 1 : 2)) expect_inside(seed, "minimal");
  }
}

} // namespace
} // namespace iga::test
