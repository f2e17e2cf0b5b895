#include "format/model/simd.hpp"
#include "preprocessor/base/gauss_rule.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

namespace iga::prep {
namespace {

TEST(GaussRule, IntegratesMonomialsUpToTwiceItsPoints) {
  for (int n : {1, 2, 3, 4, 5, 8, 13, 20, 33, 64}) {
    const LineRule& rule = gauss_legendre(n);
    ASSERT_EQ(rule.nodes.size(), static_cast<std::size_t>(n));
    for (int k = 0; k < 2 * n; ++k) {
      double sum = 0;
      for (std::size_t g = 0; g < rule.nodes.size(); ++g) sum += rule.weights[g] * std::pow(rule.nodes[g], k);
      EXPECT_NEAR(sum * (k + 1), 1, 1e-14) << n << " points, degree " << k;
    }
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      EXPECT_GT(rule.weights[g], 0);
      EXPECT_GT(rule.nodes[g], g ? rule.nodes[g - 1] : 0);
      EXPECT_LT(rule.nodes[g], 1);
    }
  }
}

template <class T> class TriangleRule : public testing::Test {};
using Numbers = testing::Types<double, long double>;
TYPED_TEST_SUITE(TriangleRule, Numbers);

TYPED_TEST(TriangleRule, IntegratesMonomialsToTheLastDigits) {
  using T = TypeParam;
  for (int degree = 0; degree <= 3 * max_moment_degree + 1; ++degree) {
    const TriangleProductRule<T>& rule = triangle_product_rule<T>(degree);
    for (std::size_t g = 0; g < rule.weights.size(); ++g) {
      EXPECT_GT(rule.weights[g], 0);
      EXPECT_GT(rule.s[g], 0);
      EXPECT_GT(rule.t[g], 0);
      EXPECT_LT(rule.s[g] + rule.t[g], 1);
    }
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) {
        T sum = 0;
        for (std::size_t g = 0; g < rule.weights.size(); ++g)
          sum += rule.weights[g] * std::pow(rule.s[g], static_cast<T>(i)) * std::pow(rule.t[g], static_cast<T>(j));
        // ∫ s^i t^j over the triangle of unit area is 2 i! j! / (i + j + 2)!
        const long double exact = 2 * std::tgammal(i + 1.0L) * std::tgammal(j + 1.0L) / std::tgammal(i + j + 3.0L);
        EXPECT_NEAR(static_cast<double>(sum / exact), 1, 64 * static_cast<double>(std::numeric_limits<T>::epsilon()))
            << "degree " << degree << ": " << i << ", " << j;
      }
  }
}

TEST(Legendre, IsOrthogonalWithValueOneAtTheEnd) {
  const LineRule& g = gauss_legendre(max_moment_degree + 1);
  double P[max_moment_degree + 1], end[max_moment_degree + 1];
  legendre(1.0, max_moment_degree, end);
  for (int a = 0; a <= max_moment_degree; ++a) {
    EXPECT_NEAR(end[a], 1, 1e-15);
    for (int b = 0; b <= max_moment_degree; ++b) {
      double sum = 0;
      for (std::size_t k = 0; k < g.nodes.size(); ++k) {
        legendre(g.nodes[k], max_moment_degree, P);
        sum += g.weights[k] * P[a] * P[b];
      }
      EXPECT_NEAR(sum, a == b ? 1.0 / (2 * a + 1) : 0, 1e-15);
    }
  }
}

TEST(Legendre, IntegralsDifferentiateBackToThePolynomials) {
  constexpr int q = max_moment_degree;
  for (int i = 1; i < 20; ++i) {
    const long double x = i / 20.0L, h = 1e-5L;
    long double P[q + 1], low[q + 1], high[q + 1];
    legendre(x, q, P);
    legendre_integrals(x - h, q, low);
    legendre_integrals(x + h, q, high);
    for (int a = 0; a <= q; ++a) EXPECT_NEAR(static_cast<double>((high[a] - low[a]) / (2 * h) - P[a]), 0, 1e-6) << a;
  }
}

// Sums of thin parts cancel: what the integrals leave at the ends must be rounding of the type that is summed.
TEST(Legendre, IntegralsVanishAtBothEndsInTheirOwnPrecision) {
  constexpr int q = max_moment_degree;
  long double G[q + 1];
  for (const long double end : {0.0L, 1.0L}) {
    legendre_integrals(end, q, G);
    for (int a = 1; a <= q; ++a) EXPECT_LE(std::abs(G[a]), 4 * std::numeric_limits<long double>::epsilon()) << a;
  }
}

TEST(Legendre, IsTheSameEightAtATime) {
  constexpr int q = max_moment_degree;
  Lanes x, P[q + 1];
  for (std::size_t lane = 0; lane < lanes; ++lane) x[lane] = 0.11 * static_cast<double>(lane);
  legendre(x, q, P);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    double one[q + 1];
    legendre(static_cast<double>(x[lane]), q, one);
    for (int a = 0; a <= q; ++a) EXPECT_NEAR(P[a][lane], one[a], 1e-15);
  }
}

} // namespace
} // namespace iga::prep
