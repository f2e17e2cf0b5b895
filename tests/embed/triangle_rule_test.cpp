#include "format/model/triangle_rule.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace iga {
namespace {

double factorial(int n) {
  return n < 2 ? 1.0 : n * factorial(n - 1);
}

class TriangleRule : public testing::TestWithParam<int> {};

// ∫ x^i y^j over the unit triangle is i! j! / (i + j + 2)!; its area is 1/2.
TEST_P(TriangleRule, IntegratesAllMonomialsUpToItsDegree) {
  const int degree = GetParam();
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) {
      double sum = 0;
      for (const auto& q : triangle_rule(degree))
        sum += q.weight * std::pow(q.barycentric[1], i) * std::pow(q.barycentric[2], j);
      EXPECT_NEAR(sum / 2, factorial(i) * factorial(j) / factorial(i + j + 2), 1e-14) << i << ' ' << j;
    }
}

TEST_P(TriangleRule, HasPositiveWeightsAndPointsStrictlyInside) {
  for (const auto& q : triangle_rule(GetParam())) {
    EXPECT_GT(q.weight, 0);
    EXPECT_NEAR(q.barycentric[0] + q.barycentric[1] + q.barycentric[2], 1, 1e-15);
    for (const double l : q.barycentric) {
      EXPECT_GT(l, 0);
      EXPECT_LT(l, 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllDegrees, TriangleRule, testing::Range(0, max_triangle_rule_degree + 1));

} // namespace
} // namespace iga
