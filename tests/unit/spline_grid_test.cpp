#include "format/model/spline_grid.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace iga {
namespace {

TEST(SplineGrid, NumbersRunUFastestAndComeBack) {
  const SplineGrid grid({0, 0, 0}, {3, 4, 5}, {3, 4, 5}, {1, 2, 3});
  EXPECT_EQ(grid.num_spans(), 60);
  EXPECT_EQ(grid.functions(), (Index3{4, 6, 8}));
  EXPECT_EQ(grid.num_functions(), 4 * 6 * 8);
  EXPECT_EQ(grid.span_number({1, 2, 3}), 1 + 3 * (2 + 4 * 3));
  EXPECT_EQ(grid.function_number({1, 2, 3}), 1 + 4 * (2 + 6 * 3));
  for (std::int64_t n = 0; n < grid.num_spans(); ++n) EXPECT_EQ(grid.span_number(grid.span_index(n)), n);
  for (std::int64_t n = 0; n < grid.num_functions(); ++n) EXPECT_EQ(grid.function_number(grid.function_index(n)), n);
}

TEST(SplineGrid, SpansTileTheBox) {
  const SplineGrid grid({-1, 2, 0.5}, {2, 3, 1}, {6, 4, 2}, {2, 2, 2});
  EXPECT_EQ(grid.span_size(), (Point3{0.5, 0.25, 0.25}));
  const Box3 first = grid.span_box({0, 0, 0}), last = grid.span_box({5, 3, 1});
  EXPECT_EQ(first.lower, grid.A());
  EXPECT_EQ(last.upper, grid.B());
  EXPECT_EQ(grid.span_box({2, 1, 0}).upper[0], grid.span_box({3, 1, 0}).lower[0]);
}

// x(u) = Σ N_i(u) P_i = C + R (u - C), the promise of the file.
TEST(SplineGrid, ControlPointsGiveTheRotatedParameter) {
  const SplineGrid grid({-1, 2, 0.5}, {2, 3, 4}, {6, 4, 3}, {1, 2, 4}, test::some_rotation(0.7));
  const Point3 u{0.37, 2.61, 1.9};
  Index3 e{};
  std::array<std::array<double, 5>, 3> N{};
  for (int d = 0; d < 3; ++d) {
    const auto i = static_cast<std::size_t>(d);
    e[i] = grid.knots(d).find_span(u[i]);
    evaluate_basis(grid.knots(d), e[i], u[i], std::span(N[i]).first(static_cast<std::size_t>(grid.degree()[i] + 1)));
  }
  Point3 x{};
  for (std::size_t c = 0; c < 5; ++c)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t a = 0; a < 2; ++a) {
        const Point3 P =
            grid.control_point({e[0] + static_cast<int>(a), e[1] + static_cast<int>(b), e[2] + static_cast<int>(c)});
        for (std::size_t d = 0; d < 3; ++d) x[d] += N[0][a] * N[1][b] * N[2][c] * P[d];
      }
  const Point3 expected = grid.to_position(u), back = grid.to_parameter(expected), centre{0.5, 2.5, 2.25};
  const Point3 fixed = grid.to_position(centre);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(x[d], expected[d], 1e-14 * 4);
    EXPECT_NEAR(back[d], u[d], 1e-14 * 4);
    EXPECT_NEAR(fixed[d], centre[d], 1e-15);
  }
}

TEST(SplineGrid, RefusesBadInput) {
  const Point3 A{0, 0, 0}, B{1, 1, 1};
  EXPECT_THROW(SplineGrid(A, {1, 0, 1}, {2, 2, 2}, {2, 2, 2}), InputError);
  EXPECT_THROW(SplineGrid(A, {1, std::numeric_limits<double>::infinity(), 1}, {2, 2, 2}, {2, 2, 2}), InputError);
  EXPECT_THROW(SplineGrid(A, B, {2, 0, 2}, {2, 2, 2}), InputError);
  EXPECT_THROW(SplineGrid(A, B, {2, 2, 2}, {2, 9, 2}), InputError);
  const Rotation mirror{{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}}, sheared{{{1, 0.1, 0}, {0, 1, 0}, {0, 0, 1}}};
  EXPECT_THROW(SplineGrid(A, B, {2, 2, 2}, {2, 2, 2}, mirror), InputError);
  EXPECT_THROW(SplineGrid(A, B, {2, 2, 2}, {2, 2, 2}, sheared), InputError);
}

} // namespace
} // namespace iga
