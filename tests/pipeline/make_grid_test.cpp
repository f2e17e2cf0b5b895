#include "preprocessor/trim/make_grid.hpp"

#include "format/model/errors.hpp"
#include "tests/support/small_surfaces.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using test::box_mesh;

// A rotation without special angles: columns are orthonormal to rounding.
Rotation general_rotation() {
  const double a = 0.5, b = 0.3;
  return {{{std::cos(a), -std::sin(a) * std::cos(b), std::sin(a) * std::sin(b)},
           {std::sin(a), std::cos(a) * std::cos(b), -std::cos(a) * std::sin(b)},
           {0, std::sin(b), std::cos(b)}}};
}

TriangleMesh moved(TriangleMesh mesh, double scale, const Rotation& R, const Point3& shift) {
  for (Point3& x : mesh.vertices) {
    const Point3 y = x;
    for (std::size_t r = 0; r < 3; ++r) x[r] = scale * (R[r][0] * y[0] + R[r][1] * y[1] + R[r][2] * y[2]) + shift[r];
  }
  return mesh;
}

// The part's box in spans from the grid's corner A.
Box3 part_in_spans(const TriangleMesh& mesh, const SplineGrid& grid) {
  Box3 box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (const Point3& x : mesh.vertices) {
    const Point3 u = grid.to_parameter(x);
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] = std::min(box.lower[d], (u[d] - grid.A()[d]) / grid.span_size()[d]);
      box.upper[d] = std::max(box.upper[d], (u[d] - grid.A()[d]) / grid.span_size()[d]);
    }
  }
  return box;
}

std::string refusal(const TriangleMesh& mesh, const GridOptions& options) {
  try {
    make_grid(mesh, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

void expect_word(const std::string& message, const std::string& word) {
  EXPECT_NE(message.find(word), std::string::npos) << message;
}

TEST(MakeGrid, KeepsTheSpanSizeAndAddsDegreeSpansOfMargin) {
  GridOptions options;
  options.span_size = {10};
  options.degree = {1, 2, 3};
  const auto grid = make_grid(box_mesh({0, 0, 0}, {100, 55, 30}), options).grid;
  EXPECT_EQ(grid.spans(), (Index3{10 + 2, 6 + 4, 3 + 6}));
  EXPECT_EQ(grid.span_size(), (Point3{10, 10, 10}));
  EXPECT_EQ(grid.A(), (Point3{-10, -22.5, -30}));
  EXPECT_EQ(grid.B(), (Point3{110, 77.5, 60}));
}

TEST(MakeGrid, DefaultsToATwentiethOfTheLongestSide) {
  const auto grid = make_grid(box_mesh({1, 2, 3}, {2, 3, 7}), {}).grid;
  EXPECT_EQ(grid.spans(), (Index3{5 + 4, 5 + 4, 20 + 4}));
  EXPECT_DOUBLE_EQ(grid.span_size()[0], 0.2);
}

TEST(MakeGrid, OneSpanCountHoldsAlongTheLongestSideWithCubicSpans) {
  GridOptions options;
  options.spans = {8};
  const auto grid = make_grid(box_mesh({0, 0, 0}, {4, 1.1, 2}), options).grid;
  EXPECT_EQ(grid.spans(), (Index3{8 + 4, 3 + 4, 4 + 4}));
  for (const double h : grid.span_size()) EXPECT_DOUBLE_EQ(h, 0.5);
}

TEST(MakeGrid, ThreeSpanCountsHoldAcrossThePartBeforeTheMargin) {
  GridOptions options;
  options.spans = {3, 7, 11};
  const auto mesh = box_mesh({0.1, 0.2, 0.3}, {1.0, 2.3, 0.7});
  const auto grid = make_grid(mesh, options).grid;
  EXPECT_EQ(grid.spans(), (Index3{3 + 4, 7 + 4, 11 + 4}));
  const Box3 part = part_in_spans(mesh, grid);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(part.lower[d], 2, 1e-12);
}

TEST(MakeGrid, AWholeNumberOfSpansUpToRoundingGetsThatNumber) {
  // Sides and sizes without exact binary form, at many positions: the quotient falls on both sides of the whole number.
  for (int k = 1; k <= 60; ++k)
    for (const double start : {0.0, 0.1, -3.7, 1234.5}) {
      GridOptions options;
      options.span_size = {0.1};
      const double end = start + 0.1 * k;
      const auto grid = make_grid(box_mesh({start, start, start}, {end, end, end}), options).grid;
      EXPECT_EQ(grid.spans()[0], k + 4) << start;
    }
}

TEST(MakeGrid, ARealRemainderGetsOneMoreSpan) {
  GridOptions options;
  options.span_size = {10};
  EXPECT_EQ(make_grid(box_mesh({0, 0, 0}, {100.01, 100, 99.99}), options).grid.spans(), (Index3{15, 14, 14}));
}

TEST(MakeGrid, FollowsAPartThatIsMovedFarAwayOrScaled) {
  const auto mesh = box_mesh({0, 0, 0}, {1, 0.73, 0.41});
  const auto base = part_in_spans(mesh, make_grid(mesh, {}).grid);
  const auto spans = make_grid(mesh, {}).grid.spans();
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double away : {0.0, 1e4}) {
      const auto other = moved(mesh, scale, identity_rotation, {away * scale, -away * scale, 0.3 * away * scale});
      const auto grid = make_grid(other, {}).grid;
      EXPECT_EQ(grid.spans(), spans);
      const auto part = part_in_spans(other, grid);
      // 1e4 sizes away a coordinate is known to 2e-12 sizes, 4e-11 spans.
      for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(part.lower[d], base.lower[d], 2e-10);
    }
}

TEST(MakeGrid, MeasuresThePartInTheRotatedFrame) {
  const auto mesh = box_mesh({0, 0, 0}, {3, 2, 1});
  const Rotation R = general_rotation();
  for (const double away : {0.0, 1e4}) {
    const auto turned = moved(mesh, 1, R, {away, 2 * away, -away});
    GridOptions options;
    options.spans = {12};
    const auto straight = make_grid(mesh, options).grid;
    options.rotation = R;
    const auto grid = make_grid(turned, options).grid;
    EXPECT_EQ(grid.spans(), straight.spans());
    const Box3 part = part_in_spans(turned, grid), expected = part_in_spans(mesh, straight);
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR(part.lower[d], expected.lower[d], 1e-9);
      EXPECT_NEAR(part.upper[d], expected.upper[d], 1e-9);
    }
  }
}

TEST(MakeGrid, EveryOffsetKeepsTheMargin) {
  const auto mesh = box_mesh({-1, 2, 5}, {0.93, 3.1, 5.4});
  for (const bool rotated : {false, true}) {
    GridOptions options;
    options.span_size = {0.1, 0.2, 0.13};
    options.degree = {1, 2, 4};
    if (rotated) options.rotation = general_rotation();
    const auto frame = *make_grid(mesh, options).frame;
    for (const double a : {0.0, 0.25, 0.5, 0.75, 1.0})
      for (const double b : {0.0, 0.1, 0.9}) {
        const auto grid = place_grid(frame, {a, b, 1 - a});
        const Box3 part = part_in_spans(mesh, grid);
        for (std::size_t d = 0; d < 3; ++d) {
          EXPECT_GE(part.lower[d], options.degree[d] - whole_span_tolerance);
          EXPECT_LE(part.upper[d], static_cast<double>(grid.spans()[d] - options.degree[d]) + whole_span_tolerance);
          EXPECT_NEAR(grid.span_size()[d], options.span_size[d], 1e-14);
        }
      }
  }
}

TEST(MakeGrid, WithoutMarginThePartStillLiesInside) {
  for (int k = 1; k <= 30; ++k) {
    GridOptions options;
    options.margin = 0;
    options.spans = {3 * k};
    const auto mesh = box_mesh({0.1 * k, -0.7, 1e3}, {0.1 * k + 1.0 / 3, 0.1, 1e3 + 0.123 * k});
    const auto grid = make_grid(mesh, options).grid;
    const Box3 box = bounding_box(mesh);
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_LE(grid.A()[d], box.lower[d]);
      EXPECT_GE(grid.B()[d], box.upper[d]);
    }
  }
}

TEST(MakeGrid, AnExplicitBoxIsKeptAndASizeThatDoesNotDivideItIsAdjusted) {
  GridOptions options;
  options.box = {Point3{0, 0, 0}, Point3{35, 20, 10}};
  options.span_size = {10};
  const auto choice = make_grid(box_mesh({1, 1, 1}, {30, 19, 9}), options);
  EXPECT_EQ(choice.grid.spans(), (Index3{4, 2, 1}));
  EXPECT_EQ(choice.grid.B(), (Point3{35, 20, 10}));
  EXPECT_DOUBLE_EQ(choice.grid.span_size()[0], 8.75);
  ASSERT_EQ(choice.notes.size(), 1U);
  expect_word(choice.notes[0], "adjusted to 8.75");
  EXPECT_FALSE(choice.frame);
}

TEST(MakeGrid, APartAsLargeAsTheBoxIsAccepted) {
  GridOptions options;
  options.box = {Point3{0.1, 0.2, 0.3}, Point3{1.1, 1.2, 1.3}};
  options.spans = {4, 5, 6};
  EXPECT_EQ(make_grid(box_mesh({0.1, 0.2, 0.3}, {1.1, 1.2, 1.3}), options).grid.spans(), (Index3{4, 5, 6}));
}

TEST(MakeGrid, RefusesBoxesThatDoNotHoldThePart) {
  const auto mesh = box_mesh({0, 0, 0}, {10, 10, 10});
  GridOptions options;
  options.box = {Point3{0, 0, 0}, Point3{10, 9, 10}};
  expect_word(refusal(mesh, options), "sticks out");
  expect_word(refusal(mesh, options), "by 1 along y");
  options.box = {Point3{20, 0, 0}, Point3{30, 10, 10}};
  expect_word(refusal(mesh, options), "misses the part");
  options.box = {Point3{0, 0, 0}, Point3{-1, 10, 10}};
  expect_word(refusal(mesh, options), "empty along x");
  options.box = {Point3{-1, -1, -1}, Point3{11, 11, 11}};
  options.rotation = general_rotation();
  expect_word(refusal(mesh, options), "in the grid's axes");
}

TEST(MakeGrid, RefusesGridsThatNoMemoryHolds) {
  const auto mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  GridOptions options;
  options.spans = {10000};
  expect_word(refusal(mesh, options), "GiB");
  options.spans = {std::int64_t{1} << 62, 1, 1};
  expect_word(refusal(mesh, options), "GiB");
  options.spans = {};
  options.span_size = {1e-300};
  expect_word(refusal(mesh, options), "GiB");
}

TEST(MakeGrid, RefusesAFlatPart) {
  expect_word(refusal(box_mesh({0, 0, 0}, {1, 1, 0}), {}), "no extent along z");
  expect_word(refusal({}, {}), "no triangles");
}

} // namespace
} // namespace iga::prep
