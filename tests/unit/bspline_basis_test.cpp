#include "format/model/bspline_basis.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace iga {
namespace {

std::vector<double> values(const KnotVector& knots, std::int64_t span, double u) {
  std::vector<double> N(static_cast<std::size_t>(knots.degree() + 1));
  evaluate_basis(knots, span, u, N);
  return N;
}

std::vector<double> slopes(const KnotVector& knots, std::int64_t span, double u) {
  std::vector<double> N(static_cast<std::size_t>(knots.degree() + 1));
  evaluate_basis_derivatives(knots, span, u, N);
  return N;
}

double sum_with(const std::vector<double>& N, auto coefficient) {
  double sum = 0;
  for (std::size_t a = 0; a < N.size(); ++a) sum += N[a] * coefficient(static_cast<std::int64_t>(a));
  return sum;
}

struct Case {
  KnotVector knots;
  double size; // of the smallest span
};

class BsplineBasis : public testing::TestWithParam<int> {
 protected:
  int p() const { return GetParam(); }
  std::vector<Case> cases() const {
    std::vector<double> uneven(static_cast<std::size_t>(p() + 1), -2);
    for (const double u : {-1.9, -1.0, 0.25, 0.75, 2.0}) uneven.push_back(u);
    uneven.insert(uneven.end(), static_cast<std::size_t>(p() + 1), 3.5);
    return {{KnotVector::uniform(p(), 1, 4, 6), 0.5},
            {KnotVector(p(), uneven), 0.1},
            {KnotVector::uniform(p(), 0, 1, 1), 1}};
  }
  /// Calls visit(knots, span, u, size) at points of all spans of all cases, faces included.
  void everywhere(auto visit) const {
    for (const auto& [knots, size] : cases())
      for (std::int64_t e = 0; e < knots.num_spans(); ++e)
        for (const double t : {0.0, 0.1, 0.5, 0.9, 1.0})
          visit(knots, e, knots.lower(e) + t * (knots.upper(e) - knots.lower(e)), size);
  }
};

TEST_P(BsplineBasis, SumsToOneAndIsNeverNegative) {
  everywhere([](const KnotVector& knots, std::int64_t e, double u, double) {
    const auto N = values(knots, e, u);
    EXPECT_NEAR(sum_with(N, [](auto) { return 1.0; }), 1, 1e-14);
    for (const double v : N) EXPECT_GE(v, -1e-15);
  });
}

TEST_P(BsplineBasis, ReproducesTheParameter) {
  everywhere([](const KnotVector& knots, std::int64_t e, double u, double) {
    EXPECT_NEAR(sum_with(values(knots, e, u), [&](auto a) { return knots.greville(e + a); }), u, 1e-14 * 4);
  });
}

// Marsden's identity for u²: the coefficient is the second elementary symmetric mean of the function's inner knots.
TEST_P(BsplineBasis, ReproducesTheSquare) {
  if (p() < 2) GTEST_SKIP() << "squares need degree 2";
  everywhere([&](const KnotVector& knots, std::int64_t e, double u, double) {
    const auto coefficient = [&](std::int64_t a) {
      double sum = 0, pairs = 0;
      for (int i = 1; i <= p(); ++i)
        for (int j = i + 1; j <= p(); ++j, ++pairs)
          sum +=
              knots.values()[static_cast<std::size_t>(e + a + i)] * knots.values()[static_cast<std::size_t>(e + a + j)];
      return sum / pairs;
    };
    EXPECT_NEAR(sum_with(values(knots, e, u), coefficient), u * u, 1e-13);
  });
}

// On uniform knots away from the ends that coefficient is g² - (p + 1) h² / 12.
TEST_P(BsplineBasis, SquareOnUniformKnotsIsTheGrevilleSquareLessAConstant) {
  if (p() < 2) GTEST_SKIP() << "squares need degree 2";
  const double h = 0.25;
  const auto knots = KnotVector::uniform(p(), 0, 20 * h, 20);
  const double u = 10.3 * h;
  const std::int64_t e = knots.find_span(u);
  const auto N = values(knots, e, u);
  EXPECT_NEAR(sum_with(N, [&](auto a) { return knots.greville(e + a) * knots.greville(e + a); }),
              u * u + (p() + 1) * h * h / 12, 1e-13);
}

TEST_P(BsplineBasis, NeighbouringSpansMeetAtTheirKnot) {
  for (const auto& [knots, size] : cases())
    for (std::int64_t e = 0; e + 1 < knots.num_spans(); ++e) {
      const auto left = values(knots, e, knots.upper(e)), right = values(knots, e + 1, knots.lower(e + 1));
      EXPECT_NEAR(left[0], 0, 1e-14);
      for (std::size_t a = 0; a + 1 < right.size(); ++a) EXPECT_NEAR(left[a + 1], right[a], 1e-14);
      EXPECT_NEAR(right.back(), 0, 1e-14);
    }
}

TEST_P(BsplineBasis, DerivativesMatchCentralDifferences) {
  everywhere([&](const KnotVector& knots, std::int64_t e, double u, double size) {
    const double step = 1e-4 * size;
    const auto dN = slopes(knots, e, u), up = values(knots, e, u + step), down = values(knots, e, u - step);
    // Error of the difference: step² N''' / 6 with |N'''| ≤ 8 p³ / size³, and rounding 1e-15 / step.
    const double bound = 1e-8 * 2 * p() * p() * p() / size + 1e-11 / size;
    for (std::size_t a = 0; a < dN.size(); ++a) EXPECT_NEAR(dN[a], (up[a] - down[a]) / (2 * step), bound);
    EXPECT_NEAR(sum_with(dN, [](auto) { return 1.0; }), 0, 1e-13 / size);
    EXPECT_NEAR(sum_with(dN, [&](auto a) { return knots.greville(e + a); }), 1, 1e-13 / size);
  });
}

TEST_P(BsplineBasis, IntegralsOverTheSupportHaveTheirClosedForm) {
  for (const auto& [knots, size] : cases()) {
    std::vector<double> total(static_cast<std::size_t>(knots.num_functions()), 0),
        own(static_cast<std::size_t>(p() + 1));
    for (std::int64_t e = 0; e < knots.num_spans(); ++e) {
      integrate_basis(knots, e, own);
      for (std::size_t a = 0; a < own.size(); ++a) total[static_cast<std::size_t>(e) + a] += own[a];
    }
    for (std::size_t i = 0; i < total.size(); ++i) {
      const double support = knots.values()[i + static_cast<std::size_t>(p()) + 1] - knots.values()[i];
      EXPECT_NEAR(total[i], support / (p() + 1), 1e-14);
    }
  }
}

// The grid's knots and control points by the route of k-refinement: elevate the linear segment, then insert the knots.
TEST_P(BsplineBasis, KRefinementOfTheLinearSegmentGivesKnotsAndGrevillePoints) {
  SplineCurve curve{1, {1, 1, 4, 4}, {1, 4}};
  for (int q = 1; q < p(); ++q) curve = elevate_degree(curve);
  const auto knots = KnotVector::uniform(p(), 1, 4, 6);
  for (std::int64_t e = 1; e < 6; ++e) curve = insert_knot(curve, knots.lower(e));
  ASSERT_EQ(curve.degree, p());
  ASSERT_TRUE(std::equal(curve.knots.begin(), curve.knots.end(), knots.values().begin(), knots.values().end()));
  ASSERT_EQ(curve.coefficients.size(), static_cast<std::size_t>(knots.num_functions()));
  for (std::size_t i = 0; i < curve.coefficients.size(); ++i)
    EXPECT_NEAR(curve.coefficients[i], knots.greville(static_cast<std::int64_t>(i)), 1e-14 * 4);
}

INSTANTIATE_TEST_SUITE_P(Degrees, BsplineBasis, testing::Range(1, max_degree + 1));

SplineCurve wild_curve() {
  return {3, {0, 0, 0, 0, 0.2, 0.5, 0.5, 0.9, 0.9, 0.9, 1, 1, 1, 1}, {1, -2, 0.5, 4, 3, -1, 2, 7, 0, 1}};
}

void expect_same_curve(const SplineCurve& a, const SplineCurve& b) {
  for (int i = 0; i <= 100; ++i)
    EXPECT_NEAR(evaluate(a, i / 100.0), evaluate(b, i / 100.0), 1e-12) << "at " << i / 100.0;
}

TEST(SplineCurve, AgreesWithTheBasis) {
  const auto knots = KnotVector::uniform(3, 0, 1, 4);
  const SplineCurve curve{3, {knots.values().begin(), knots.values().end()}, {1, -2, 0.5, 4, 3, -1, 2}};
  for (const double u : {0.0, 0.1, 0.25, 0.6, 1.0}) {
    const auto e = knots.find_span(u);
    const auto expected =
        sum_with(values(knots, e, u), [&](auto a) { return curve.coefficients[static_cast<std::size_t>(e + a)]; });
    EXPECT_NEAR(evaluate(curve, u), expected, 1e-14 * 8);
  }
}

TEST(SplineCurve, InsertionKeepsTheCurve) {
  SplineCurve curve = wild_curve();
  for (const double u : {0.1, 0.2, 0.5, 0.7, 0.7, 0.95}) {
    curve = insert_knot(curve, u);
    ASSERT_EQ(curve.knots.size(), curve.coefficients.size() + 4);
    expect_same_curve(curve, wild_curve());
  }
}

TEST(SplineCurve, ElevationKeepsTheCurveAndRaisesMultiplicities) {
  const SplineCurve once = elevate_degree(wild_curve()), twice = elevate_degree(once);
  EXPECT_EQ(once.degree, 4);
  EXPECT_EQ(std::count(once.knots.begin(), once.knots.end(), 0.5), 3);
  EXPECT_EQ(once.knots.size(), once.coefficients.size() + 5);
  expect_same_curve(once, wild_curve());
  expect_same_curve(twice, wild_curve());
}

TEST(SplineCurve, RefusesParametersOutsideAndFullKnots) {
  EXPECT_THROW(evaluate(wild_curve(), -0.1), InputError);
  EXPECT_THROW(insert_knot(wild_curve(), 1.1), InputError);
  EXPECT_THROW(insert_knot(wild_curve(), 0.9), InputError);
}

} // namespace
} // namespace iga
