#include "format/model/knot_vector.hpp"

#include "format/model/errors.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace iga {
namespace {

class UniformKnots : public testing::TestWithParam<int> {};

TEST_P(UniformKnots, CountSpansAndFunctions) {
  const int p = GetParam();
  const auto knots = KnotVector::uniform(p, -1, 3, 7);
  EXPECT_EQ(knots.num_spans(), 7);
  EXPECT_EQ(knots.num_functions(), 7 + p);
  EXPECT_EQ(knots.values().size(), static_cast<std::size_t>(7 + 2 * p + 1));
  EXPECT_EQ(knots.lower(0), -1);
  EXPECT_EQ(knots.upper(6), 3);
}

TEST_P(UniformKnots, EveryParameterLiesInItsSpan) {
  const auto knots = KnotVector::uniform(GetParam(), 0.1, 1.3, 11);
  for (std::int64_t e = 0; e < 11; ++e) {
    EXPECT_EQ(knots.find_span(knots.lower(e)), e);
    EXPECT_EQ(knots.find_span(0.5 * (knots.lower(e) + knots.upper(e))), e);
    EXPECT_EQ(knots.find_span(std::nextafter(knots.upper(e), 0)), e);
  }
  EXPECT_EQ(knots.find_span(1.3), 10);
  EXPECT_EQ(knots.find_span(99), 10);
  EXPECT_EQ(knots.find_span(-99), 0);
}

INSTANTIATE_TEST_SUITE_P(Degrees, UniformKnots, testing::Range(1, max_degree + 1));

TEST(KnotVector, RefusesWhatIsNoOpenKnotVector) {
  EXPECT_THROW(KnotVector(0, {0, 1}), InputError);
  EXPECT_THROW(KnotVector(max_degree + 1, std::vector<double>(20, 0.0)), InputError);
  EXPECT_THROW(KnotVector(2, {0, 0, 0, 1, 1}), InputError);              // too short
  EXPECT_THROW(KnotVector(2, {0, 0, 0.1, 1, 1, 1}), InputError);         // not clamped
  EXPECT_THROW(KnotVector(2, {0, 0, 0, 0.5, 0.5, 1, 1, 1}), InputError); // double inner knot
  EXPECT_THROW(KnotVector(1, {0, 0, 0.7, 0.3, 1, 1}), InputError);       // falling
  EXPECT_THROW(KnotVector(1, {0, 0, std::numeric_limits<double>::quiet_NaN(), 1, 1}), InputError);
  EXPECT_THROW(KnotVector::uniform(2, 0, 1, 0), InputError);
  EXPECT_THROW(KnotVector::uniform(9, 0, 1, 4), InputError);
  EXPECT_NO_THROW(KnotVector(2, {0, 0, 0, 0.3, 1, 1, 1}));
}

} // namespace
} // namespace iga
