#include "preprocessor/trim/optimise_offset.hpp"

#include "tests/support/small_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using test::box_mesh;

// ∫ over the covered part of each span, taken as fraction × ∫ over the span, of every function along one direction, as
// a share of its whole integral. A box's mass fractions are products of three such values.
std::vector<double> shares(const KnotVector& knots, double lower, double upper) {
  // ∫ N_i = (knots[i + p + 1] - knots[i]) / (p + 1); over one span it is the difference of two integrals of degree p +
  // 1, here by a fine midpoint rule on Cox–de Boor values written out recursively.
  const auto t = knots.values();
  const int p = knots.degree();
  const auto value = [&](auto&& self, std::size_t i, int q, double u) -> double {
    if (q == 0) return t[i] <= u && u < t[i + 1] ? 1 : 0;
    const auto k = static_cast<std::size_t>(q);
    const double left = t[i + k] > t[i] ? (u - t[i]) / (t[i + k] - t[i]) * self(self, i, q - 1, u) : 0;
    const double right =
        t[i + k + 1] > t[i + 1] ? (t[i + k + 1] - u) / (t[i + k + 1] - t[i + 1]) * self(self, i + 1, q - 1, u) : 0;
    return left + right;
  };
  std::vector<double> out(static_cast<std::size_t>(knots.num_functions()), 0.0);
  for (std::int64_t e = 0; e < knots.num_spans(); ++e) {
    const double a = knots.lower(e), b = knots.upper(e);
    const double fraction = std::max(0.0, std::min(b, upper) - std::max(a, lower)) / (b - a);
    constexpr int samples = 200;
    for (std::size_t i = static_cast<std::size_t>(e); i <= static_cast<std::size_t>(e + p); ++i) {
      double integral = 0;
      for (int s = 0; s < samples; ++s)
        integral += value(value, i, p, a + (b - a) * (s + 0.5) / samples) * (b - a) / samples;
      out[i] += fraction * integral / ((t[i + static_cast<std::size_t>(p) + 1] - t[i]) / (p + 1));
    }
  }
  return out;
}

TEST(LightFunctionCount, OfABoxFollowsFromItsThreeSides) {
  const Point3 lower{0, 0, 0}, upper{1, 0.77, 0.52};
  const auto mesh = box_mesh(lower, upper);
  for (const std::array<int, 3>& degree : {std::array<int, 3>{2, 2, 2}, std::array<int, 3>{1, 3, 2}}) {
    GridOptions options;
    options.degree = degree;
    options.span_size = {0.17};
    options.margin = 1; // less than the degree: functions of the open ends count too
    const auto grid = make_grid(mesh, options).grid;
    std::array<std::vector<double>, 3> along;
    for (int d = 0; d < 3; ++d) {
      const auto e = static_cast<std::size_t>(d);
      along[e] = shares(grid.knots(d), lower[e], upper[e]);
    }
    std::int64_t expected = 0;
    for (const double w : along[2])
      for (const double v : along[1])
        for (const double u : along[0]) expected += u * v * w > 0 && u * v * w < light_mass_fraction;
    EXPECT_EQ(light_function_count(grid, trim(grid, mesh, {})), expected);
    EXPECT_GT(expected, 0);
  }
}

// A box turned by 30° about z: shifts change how many spans its slanted sides graze.
TriangleMesh slanted_box() {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 0.9, 0.55});
  for (Point3& x : mesh.vertices) x = {x[0] * std::sqrt(0.75) - x[1] * 0.5, x[0] * 0.5 + x[1] * std::sqrt(0.75), x[2]};
  return mesh;
}

TEST(OptimiseOffset, NeverLosesAndCountsWhatTheGridThenHolds) {
  const auto mesh = slanted_box();
  GridOptions options;
  options.span_size = {0.13};
  const auto frame = *make_grid(mesh, options).frame;
  const auto never = [] { return false; };
  const auto silent = [](std::int64_t, std::int64_t) {};
  const auto first = optimise_offset(frame, mesh, {}, silent, never);
  const auto second = optimise_offset(frame, mesh, {}, silent, never);
  EXPECT_LT(first.light_after, first.light_before);
  EXPECT_EQ(first.offset, second.offset);
  const auto grid = place_grid(frame, first.offset);
  EXPECT_EQ(light_function_count(grid, trim(grid, mesh, {})), first.light_after);
}

TEST(OptimiseOffset, StopsWhenAsked) {
  const auto mesh = box_mesh({0, 0, 0}, {1, 0.9, 0.55});
  const auto frame = *make_grid(mesh, {}).frame;
  const auto search = optimise_offset(
      frame, mesh, {}, [](std::int64_t, std::int64_t) {}, [] { return true; });
  EXPECT_EQ(search.evaluations, 0);
  EXPECT_EQ(search.offset, centred_offset(frame));
}

} // namespace
} // namespace iga::prep
