// Rules with fewer points: exact moments, positive weights, points inside, counts.
#include "preprocessor/reduce/span_reduction.hpp"

#include "format/model/vec3.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/fitted_rules.hpp"

#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace iga::prep {
namespace {

using namespace iga::test;

TriangleMesh turned_cube(double half) {
  return transformed(box({-half, -half, -half}, {half, half, half}), rotation(30, 20), {2.5, 2.4, 2.6});
}

// A cube with a cubic cavity: its surface is convex nowhere the cavity shows.
TriangleMesh cube_with_cavity() {
  return join({box({0.3, 0.3, 0.3}, {4.7, 4.7, 4.7}),
               flipped(transformed(box({-1, -1, -1}, {1, 1, 1}), rotation(25, 35), {2.5, 2.4, 2.6}))});
}

struct Reduced {
  std::vector<Fitted> rules;
  ReductionCounts counts;
  std::vector<double> fraction;

  double average() const {
    double points = 0;
    for (const Fitted& f : rules) points += static_cast<double>(f.rule.weights.size());
    return points / static_cast<double>(rules.size());
  }
};

Reduced reduce_all(const SplineGrid& grid, const TriangleMesh& mesh, const std::array<int, 3>& degree,
                   bool rank_bound = false) {
  Reduced reduced;
  reduced.rules = fit_all(grid, mesh, degree, [&](Fitted& f, const Trimming& trimming, const FarMoments& far) {
    SpanReducer reducer(grid, trimming, far, degree, 1e-10, rank_bound);
    reducer.reduce(f.touched, f.rule);
    reduced.counts += reducer.counts();
    reduced.fraction.push_back(trimming.touched_fraction[f.touched]);
  });
  return reduced;
}

TEST(MomentEquations, JacobianIsTheDerivativeOfTheResidual) {
  const std::array<int, 3> degree{2, 3, 1};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0.1, 0.9);
  const std::vector<double> moments(24, 0.3);
  for (const int fixed : {-1, 1}) {
    MomentEquations equations;
    equations.start(degree, moments, fixed);
    PointSet points;
    for (int k = 0; k < 4; ++k) {
      for (int d = 0; d < 3; ++d) points.x.push_back(any(random));
      points.w.push_back(any(random));
    }
    const std::vector<UnknownScale> scale{{1, 0.5}, {0.2, 0.1}, {3, 1}, {0.7, 0.4}};
    Eigen::MatrixXd J;
    equations.jacobian(points, scale, J);
    Eigen::Index column = 0;
    const auto check = [&](double& unknown, double unit) {
      constexpr double step = 1e-6;
      Eigen::VectorXd up, down;
      const double at = unknown;
      unknown = at + step * unit;
      equations.residual(points, up);
      unknown = at - step * unit;
      equations.residual(points, down);
      unknown = at;
      EXPECT_LE((J.col(column++) - (up - down) / (2 * step)).norm(), 1e-8);
    };
    for (std::size_t k = 0; k < points.size(); ++k) {
      check(points.w[k], scale[k].weight);
      for (std::size_t d = 0; d < 3; ++d)
        if (static_cast<int>(d) != fixed) check(points.x[3 * k + d], scale[k].place);
    }
    EXPECT_EQ(column, J.cols());
  }
}

// The clearance of random ways against dense sampling of the span: a ball of that radius holds no point outside.
TEST(PieceInterior, ClearanceIsABoundAndSeesTheSurfaceInBetween) {
  const SplineGrid grid = grid_of(5);
  int left = 0, stayed = 0;
  for (const TriangleMesh& mesh : {turned_cube(1.3), cube_with_cavity()}) {
    const Trimming trimming = trim(grid, mesh, {});
    const FarMoments far(grid, trimming, {2, 2, 2});
    SpanPart part(grid, trimming, far, {2, 2, 2});
    PieceInterior interior;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0, 1);
    for (std::size_t t = 0; t < trimming.pieces.spans.size(); t += 3) {
      part.open(t);
      if (part.surface().fraction < 1e-3 || part.surface().fraction > 1 - 1e-9) continue;
      interior.attach(part.surface());
      std::vector<Point3> in, out;
      for (int i = 0; i < 400; ++i) {
        const Point3 x{any(random), any(random), any(random)};
        (part.interior().holds(x) ? in : out).push_back(x);
      }
      if (in.empty()) continue;
      for (std::size_t i = 0; i < std::min<std::size_t>(in.size(), 20); ++i) {
        const double clear = interior.clearance(in[i]);
        EXPECT_GT(clear, 0);
        for (const Point3& x : out) EXPECT_GT(norm(minus(x, in[i])), clear * (1 - 1e-12));
        for (std::size_t d = 0; d < 3; ++d) EXPECT_LE(clear, std::min(in[i][d], 1 - in[i][d]));
        if (i < in.size() / 2) {
          EXPECT_GT(interior.clearance(in[i], in[in.size() - 1 - i]), 0);
          ++stayed;
        }
        if (i < out.size()) {
          EXPECT_LT(interior.clearance(out[i], in[i]), 0);
          ++left;
        }
      }
    }
  }
  EXPECT_GT(left, 200);
  EXPECT_GT(stayed, 200);
}

struct Goal {
  int degree;
  double average;
};
class ReducedCube : public testing::TestWithParam<Goal> {};

TEST_P(ReducedCube, FarFewerPointsAndTheSameMoments) {
  const auto [p, average] = GetParam();
  const std::array<int, 3> degree{p, p, p};
  const SplineGrid grid = grid_of(5, p);
  const TriangleMesh mesh = turned_cube(p == 2 ? 1.45 : 1.2);
  const Reduced reduced = reduce_all(grid, mesh, degree);
  EXPECT_GT(reduced.rules.size(), 20u);
  EXPECT_LE(reduced.average(), average);
  for (std::size_t i = 0; i < reduced.rules.size(); i += p == 2 ? 2 : 6)
    expect_valid(grid, mesh, reduced.rules[i], degree);
}

INSTANTIATE_TEST_SUITE_P(Degrees, ReducedCube, testing::Values(Goal{1, 3.2}, Goal{2, 9.5}, Goal{3, 20.5}),
                         [](const auto& c) { return "p" + std::to_string(c.param.degree); });

TEST(SpanReducer, MixedDegreesAndHighMoments) {
  const TriangleMesh mesh = turned_cube(0.5);
  for (const std::array<int, 3>& degree : {std::array<int, 3>{1, 2, 4}, {4, 4, 2}, {4, 4, 4}}) {
    const SplineGrid grid = grid_of(5);
    const Reduced reduced = reduce_all(grid, mesh, degree);
    const auto moments = static_cast<double>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1));
    EXPECT_LE(reduced.average(), 0.45 * moments);
    for (std::size_t i = 0; i < reduced.rules.size(); i += 5) expect_valid(grid, mesh, reduced.rules[i], degree);
  }
}

TEST(SpanReducer, BoxesKeepEightPointsAndPrismsStayProducts) {
  const SplineGrid grid = grid_of(5);
  for (const Fitted& f : reduce_all(grid, box({1.25, 1.5, 1.125}, {3.75, 3.25, 3.5}), {2, 2, 2}).rules)
    EXPECT_EQ(f.rule.weights.size(), 8u);
  const TriangleMesh mesh = prism({{1.2, 1.3}, {3.7, 1.6}, {2.1, 3.8}}, {{0, 1, 2}}, 1.25, 3.5);
  for (const Fitted& f : reduce_all(grid, mesh, {2, 2, 2}).rules) {
    EXPECT_EQ(f.rule.shape, SpanShape::Prism);
    EXPECT_LE(f.rule.weights.size(), 12u);
    const std::size_t half = f.rule.weights.size() / 2;
    for (std::size_t k = 0; k < half; ++k)
      for (std::size_t d = 0; d < 2; ++d) EXPECT_EQ(f.rule.points[3 * k + d], f.rule.points[3 * (k + half) + d]);
    expect_valid(grid, mesh, f, {2, 2, 2});
  }
}

// Convexity is no help here: the judge is the residual, and the lines through the span.
TEST(SpanReducer, PiecesThatAreNotConvex) {
  const SplineGrid grid = grid_of(5);
  const TriangleMesh mesh = cube_with_cavity();
  const Trimming trimming = trim(grid, mesh, {});
  const FarMoments far(grid, trimming, {2, 2, 2});
  SpanPart part(grid, trimming, far, {2, 2, 2});
  PieceInterior interior;
  const Reduced reduced = reduce_all(grid, mesh, {2, 2, 2});
  EXPECT_LE(reduced.average(), 10);
  int bent = 0;
  for (const Fitted& f : reduced.rules) {
    part.open(f.touched);
    interior.attach(part.surface());
    bent += !interior.is_convex();
    std::vector<double> x = f.rule.points, w = f.rule.weights;
    part.to_box(x, w);
    EXPECT_LE(part.residual(x, w), 1e-10);
    for (std::size_t k = 0; k < w.size(); ++k) {
      EXPECT_GT(w[k], 0);
      EXPECT_TRUE(part.interior().holds({x[3 * k], x[3 * k + 1], x[3 * k + 2]}));
    }
  }
  EXPECT_GT(bent, 8);
}

TEST(SpanReducer, RankBoundKeepsAsManyPointsAsTheStiffnessHasRank) {
  EXPECT_EQ(rank_points({2, 2, 2}), 13u);
  EXPECT_EQ(rank_points({3, 3, 3}), 31u);
  EXPECT_EQ(rank_points({4, 4, 4}), 62u);
  const SplineGrid grid = grid_of(5);
  for (const TriangleMesh& mesh : {turned_cube(1.45), box({1.25, 1.5, 1.125}, {3.75, 3.25, 3.5}),
                                   prism({{1.2, 1.3}, {3.7, 1.6}, {2.1, 3.8}}, {{0, 1, 2}}, 1.25, 3.5)}) {
    const Reduced reduced = reduce_all(grid, mesh, {2, 2, 2}, true);
    for (std::size_t i = 0; i < reduced.rules.size(); ++i) {
      if (reduced.fraction[i] >= 0.1) {
        EXPECT_GE(reduced.rules[i].rule.weights.size(), 13u);
      }
      EXPECT_LE(reduced.rules[i].rule.weights.size(), 27u);
    }
  }
}

QuadratureOptions minimal() {
  QuadratureOptions options;
  options.trimmed_rule = "minimal";
  return options;
}

TEST(MinimalRules, DoNotDependOnTheNumberOfThreads) {
  const SplineGrid grid = grid_of(5);
  const Trimming trimming = trim(grid, cube_with_cavity(), {});
  const IntegrationPoints many = build_quadrature(grid, trimming, minimal()).points;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const IntegrationPoints single = build_quadrature(grid, trimming, minimal()).points;
  EXPECT_EQ(many.offsets, single.offsets);
  EXPECT_EQ(many.parameters, single.parameters);
  EXPECT_EQ(many.weights, single.weights);
}

TEST(MinimalRules, InterruptedReductionKeepsTheFittedRules) {
  const SplineGrid grid = grid_of(12);
  const TriangleMesh mesh = transformed(box({-3.5, -3.5, -3.5}, {3.5, 3.5, 3.5}), rotation(30, 20), {6.1, 5.9, 6.05});
  const Trimming trimming = trim(grid, mesh, {});
  QuadratureOptions options = minimal();
  TrimmedRules rules(grid, trimming, options);
  std::atomic<int> polls{0};
  options.cancelled = [&] { return ++polls > 50; };
  rules.reduce(options);
  rules.secure(options);
  EXPECT_GT(rules.counts().kept_spans, 100);
  EXPECT_GT(rules.counts().reduction.newton, 50);
  const QuadratureResult result = place_points(grid, trimming, options, std::move(rules));
  EXPECT_LE(result.max_residual, 1e-10);
  double volume = 0;
  for (const double w : result.points.weights) volume += w;
  EXPECT_NEAR(volume, 343, 1e-9);
}

} // namespace
} // namespace iga::prep
