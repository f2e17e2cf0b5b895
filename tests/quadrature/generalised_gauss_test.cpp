// Rules on runs of spans: known values, counts, and exactness for splines that the rules never saw.
#include "preprocessor/interior/generalised_gauss.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/base/gauss_rule.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numeric>

namespace iga::prep {
namespace {

struct Case {
  const char* rule;
  int p;
};
constexpr std::array cases{Case{"gauss", 2},        Case{"ggq", 1},         Case{"ggq", 2},
                           Case{"ggq", 3},          Case{"ggq", 4},         Case{"ggq-reduced", 1},
                           Case{"ggq-reduced", 2},  Case{"ggq-reduced", 3}, Case{"ggq-reduced", 4},
                           Case{"ggq-reduced2", 3}, Case{"ggq-reduced2", 4}};

std::vector<std::int64_t> run_lengths() {
  std::vector<std::int64_t> lengths(25);
  std::iota(lengths.begin(), lengths.end(), 1);
  lengths.insert(lengths.end(), {40, 60, 100, 333});
  return lengths;
}

template <class Use> void for_nodes(const RunRule& rule, Use&& use) {
  for (std::int64_t i = 0; i < rule.spans(); ++i)
    for (std::int32_t q = rule.first[static_cast<std::size_t>(i)]; q < rule.first[static_cast<std::size_t>(i) + 1]; ++q)
      use(i, rule.position[static_cast<std::size_t>(q)], rule.weights[static_cast<std::size_t>(q)]);
}

std::vector<double> positions(const RunRule& rule) {
  std::vector<double> x;
  for_nodes(rule, [&](std::int64_t i, double t, double) { x.push_back(static_cast<double>(i) + t); });
  return x;
}

// N N, N' N, N N', N' N' of functions i and i + k on a run, by any rule: entry [(i (p + 1) + k) 4 + kind].
std::vector<double> products(const RunRule& rule, int p) {
  // All spans look alike from inside: p spans lie before and behind this one.
  const KnotVector knots = KnotVector::uniform(p, 0, 2.0 * p + 1, 2 * p + 1);
  const auto width = static_cast<std::size_t>(p) + 1;
  std::vector<double> sums(static_cast<std::size_t>(rule.spans() + p) * width * 4, 0), N(width), D(width);
  for_nodes(rule, [&](std::int64_t s, double t, double w) {
    evaluate_basis(knots, p, p + t, N);
    evaluate_basis_derivatives(knots, p, p + t, D);
    for (std::size_t a = 0; a < width; ++a)
      for (std::size_t b = a; b < width; ++b) {
        double* sum = &sums[((static_cast<std::size_t>(s) + a) * width + (b - a)) * 4];
        sum[0] += w * N[a] * N[b];
        sum[1] += w * D[a] * N[b];
        sum[2] += w * N[a] * D[b];
        sum[3] += w * D[a] * D[b];
      }
  });
  return sums;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// B-spline j of degree q over knots relative to the evaluation span: Cox and de Boor's definition, word for word.
double bspline(const std::vector<double>& knots, std::size_t j, std::size_t q, double t, std::size_t interval) {
  if (q == 0) return j == interval ? 1 : 0;
  double value = 0;
  if (const double length = knots[j + q] - knots[j]; length > 0)
    value += (t - knots[j]) / length * bspline(knots, j, q - 1, t, interval);
  if (const double length = knots[j + q + 1] - knots[j + 1]; length > 0)
    value += (knots[j + q + 1] - t) / length * bspline(knots, j + 1, q - 1, t, interval);
  return value;
}

// Largest error over the B-splines of the target space, whose integrals are (t_{j+d+1} - t_j) / (d + 1).
double target_error(const RunRule& rule, const TargetSpace& space) {
  const auto d = static_cast<std::size_t>(space.degree);
  const auto multiplicity = static_cast<std::size_t>(space.degree - space.continuity);
  std::vector<double> knots(d + 1, 0);
  for (std::int64_t e = 1; e < rule.spans(); ++e) knots.insert(knots.end(), multiplicity, static_cast<double>(e));
  knots.insert(knots.end(), d + 1, static_cast<double>(rule.spans()));
  std::vector<double> error(knots.size() - d - 1);
  for (std::size_t j = 0; j < error.size(); ++j)
    error[j] = -(knots[j + d + 1] - knots[j]) / static_cast<double>(space.degree + 1);
  for_nodes(rule, [&](std::int64_t s, double t, double w) {
    const std::size_t first = static_cast<std::size_t>(s) * multiplicity;
    // Knots near the span, relative to it: no digits are lost far along the run.
    std::vector<double> local(knots.begin() + static_cast<std::ptrdiff_t>(first),
                              knots.begin() + static_cast<std::ptrdiff_t>(first + 2 * d + 2));
    for (double& knot : local) knot -= static_cast<double>(s);
    for (std::size_t a = 0; a <= d; ++a) error[first + a] += w * bspline(local, a, d, t, d);
  });
  double largest = 0;
  for (const double e : error) largest = std::max(largest, std::abs(e));
  return largest;
}

TEST(GeneralisedGauss, CountsAreHalfTheDimensionOfTheSpace) {
  const auto expect = [](const char* rule, int p, const std::vector<std::pair<int, int>>& counts) {
    for (const auto& [spans, points] : counts) {
      EXPECT_EQ(run_points(target_space(rule, p), spans), points) << rule << " p " << p << " e " << spans;
      EXPECT_EQ(run_rule(target_space(rule, p), spans)->weights.size(), static_cast<std::size_t>(points));
    }
  };
  expect("ggq", 2, {{1, 3}, {2, 5}, {3, 7}, {4, 9}, {10, 21}, {20, 41}});
  expect("ggq", 3, {{1, 4}, {2, 6}, {3, 9}, {4, 11}, {10, 26}, {20, 51}});
  expect("ggq", 4, {{1, 5}, {2, 8}, {3, 11}, {4, 14}, {10, 32}, {20, 62}});
  expect("ggq-reduced", 2, {{6, 10}});
  expect("ggq-reduced", 3, {{5, 11}});
  expect("ggq-reduced2", 3, {{5, 9}});
  // Derivatives jump at p = 1: Gauss in every span, with two points also where it is called reduced.
  expect("ggq", 1, {{1, 2}, {7, 14}});
  expect("ggq-reduced", 1, {{1, 2}, {7, 14}});
  expect("gauss", 3, {{1, 4}, {7, 28}});
}

TEST(GeneralisedGauss, KnownRules) {
  const auto expect = [](const char* rule, int p, std::int64_t spans, const std::vector<double>& x,
                         const std::vector<double>& w) {
    const auto found = run_rule(target_space(rule, p), spans);
    const std::vector<double> nodes = positions(*found);
    for (std::size_t q = 0; q < x.size(); ++q) {
      EXPECT_NEAR(nodes[q], x[q], 3e-15) << rule << " p " << p << " e " << spans << " node " << q;
      EXPECT_NEAR(found->weights[q], w[q], 3e-15) << rule << " p " << p << " e " << spans << " node " << q;
    }
  };
  expect("ggq", 2, 3, {0.1550510257216822, 0.6449489742783178, 1.0641101056459326, 1.5},
         {0.3764030627004672, 0.5124858261884215, 0.3654970760233917, 0.4912280701754386});
  expect("ggq", 3, 2, {0.0924254744365225, 0.4275957012000423, 0.8279244012980120},
         {0.2300483628893542, 0.4061452268756671, 0.3638064102349787});
  expect("ggq", 4, 2, {0.0586347311172141, 0.2843154095499076, 0.5997136508541584, 0.8876233327475115},
         {0.1475707772347533, 0.2890388427543198, 0.3211299506025984, 0.2422604294083273});
  for (int p = 2; p <= 4; ++p) expect("ggq", p, 1, gauss_legendre(p + 1).nodes, gauss_legendre(p + 1).weights);
}

TEST(GeneralisedGauss, LongRunsArePeriodicAwayFromTheirEnds) {
  const auto ggq = run_rule(target_space("ggq", 2), 60);
  for (std::int64_t i = 12; i < 18; ++i) {
    const auto q = static_cast<std::size_t>(ggq->first[static_cast<std::size_t>(i)]);
    ASSERT_EQ(ggq->count(i), 2);
    EXPECT_NEAR(ggq->position[q], 0.0940035126562314, 1e-14);
    EXPECT_NEAR(ggq->weights[q], 0.4554564596812625, 1e-14);
    EXPECT_NEAR(ggq->position[q + 1], 0.6231537748691495, 1e-14);
    EXPECT_NEAR(ggq->weights[q + 1], 0.5445435403187374, 1e-14);
  }
  const auto reduced = run_rule(target_space("ggq-reduced", 2), 60);
  for (std::size_t q = 24; q < 36; ++q) EXPECT_NEAR(reduced->weights[q], 2.0 / 3, 1e-14);
}

TEST(GeneralisedGauss, NodesLieInTheirSpansAscendSymmetricWithPositiveWeights) {
  for (const Case& c : cases)
    for (const std::int64_t e : run_lengths()) {
      SCOPED_TRACE(std::string(c.rule) + " p " + std::to_string(c.p) + " e " + std::to_string(e));
      const auto rule = run_rule(target_space(c.rule, c.p), e);
      ASSERT_EQ(rule->spans(), e);
      ASSERT_EQ(rule->first.back(), static_cast<std::int32_t>(rule->weights.size()));
      const std::vector<double> x = positions(*rule);
      ASSERT_EQ(x.size(), static_cast<std::size_t>(run_points(target_space(c.rule, c.p), e)));
      double sum = 0;
      for (std::size_t q = 0; q < x.size(); ++q) {
        ASSERT_TRUE(rule->position[q] >= 0 && rule->position[q] <= 1);
        ASSERT_TRUE(q == 0 || x[q] > x[q - 1]);
        ASSERT_GT(rule->weights[q], 0);
        ASSERT_EQ(rule->weights[q], rule->weights[x.size() - 1 - q]);
        ASSERT_NEAR(x[q] + x[x.size() - 1 - q], static_cast<double>(e), 1e-13);
        sum += rule->weights[q];
      }
      EXPECT_NEAR(sum, static_cast<double>(e), 1e-15 * static_cast<double>(e * e + 4));
    }
}

TEST(GeneralisedGauss, GgqIsExactForAllProductsOfFunctionsAndDerivatives) {
  for (int p = 1; p <= 4; ++p)
    for (const std::int64_t e : run_lengths()) {
      const auto exact = products(*run_rule(target_space("gauss", p), e), p);
      EXPECT_LT(largest_difference(products(*run_rule(target_space("ggq", p), e), p), exact), 1e-13)
          << "p " << p << " e " << e;
    }
}

TEST(GeneralisedGauss, RulesAreExactForTheirTargetSpaces) {
  for (const Case& c : cases)
    for (const std::int64_t e : run_lengths()) {
      const TargetSpace space = target_space(c.rule, c.p);
      EXPECT_LT(target_error(*run_rule(space, e), space), 1e-13) << c.rule << " p " << c.p << " e " << e;
    }
}

TEST(GeneralisedGauss, EveryLengthIsFoundFromSeveralThreads) {
  tbb::parallel_for(std::int64_t{1}, std::int64_t{200}, [](std::int64_t e) {
    for (const Case& c : cases) {
      const auto rule = run_rule(target_space(c.rule, c.p), e);
      ASSERT_EQ(rule.get(), run_rule(target_space(c.rule, c.p), e).get());
    }
  });
}

TEST(GeneralisedGauss, RefusesUnknownNamesAndHourglassModes) {
  EXPECT_THROW(target_space("simpson", 2), InputError);
  for (const int p : {1, 2}) {
    try {
      target_space("ggq-reduced2", p);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("hourglass"), std::string::npos);
    }
  }
}

} // namespace
} // namespace iga::prep
