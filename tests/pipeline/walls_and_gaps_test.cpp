// Walls and gaps of known size: warned of where the spans are too coarse for them, and nowhere else.
#include "preprocessor/walls/narrow_gaps.hpp"
#include "preprocessor/walls/wall_thickness.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace iga::prep {
namespace {

using namespace iga::test;

constexpr double degrees = std::numbers::pi / 180;

using Outline = std::vector<std::array<double, 2>>;

Outline circle(double radius, int corners) {
  Outline out;
  for (int i = 0; i < corners; ++i)
    out.push_back(
        {radius * std::cos(2 * std::numbers::pi * i / corners), radius * std::sin(2 * std::numbers::pi * i / corners)});
  return out;
}

/// Circle with its points moved outwards onto a square of that half side.
Outline square(double half, int corners) {
  Outline out = circle(half, corners);
  for (auto& p : out) {
    const double stretch = half / std::max(std::abs(p[0]), std::abs(p[1]));
    p = {p[0] * stretch, p[1] * stretch};
  }
  return out;
}

/// What lies between two outlines of as many points.
TriangleMesh ring(const Outline& outer, const Outline& inner, double length) {
  TriangleMesh m;
  const auto n = static_cast<std::int32_t>(outer.size());
  for (const double z : {0.0, length})
    for (const Outline* outline : {&outer, &inner})
      for (const auto& p : *outline) m.vertices.push_back({p[0], p[1], z});
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n, top = 2 * n;
    quad(i, j, j + top, i + top);
    quad(j + n, i + n, i + n + top, j + n + top);
    quad(i, i + n, j + n, j);
    quad(i + top, j + top, j + n + top, i + n + top);
  }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"ring"};
  return m;
}

/// A block of 9 × 8 × `depth of slot` + 4 with a slot from above between two prongs 4 wide each.
TriangleMesh fork(double slot, double depth) {
  const double w = 4, h = 4 + depth;
  return prism({{0, 0}, {2 * w + slot, 0}, {2 * w + slot, h}, {w + slot, h}, {w + slot, 4}, {w, 4}, {w, h}, {0, h}},
               {{0, 1, 4}, {0, 4, 5}, {1, 2, 4}, {2, 3, 4}, {0, 5, 7}, {5, 6, 7}}, 0, 8);
}

struct Found {
  ThinWalls walls;
  std::optional<NarrowGap> gap;
};

Found measure(const TrimmedModel& model) {
  const TriangleTree tree(model.surface.mesh);
  const auto samples = sample_surface(model, 20000);
  return {find_thin_walls(model, tree, samples), find_narrow_gap(model, tree, samples)};
}

Found measure(const TriangleMesh& mesh, const PartOptions& options) {
  return measure(make_part(mesh, options));
}

PartOptions spans_of(double size, double shift = 0.37, const Rotation& R = identity_rotation) {
  PartOptions options;
  options.span_size = size;
  options.shift = shift;
  options.rotation = R;
  return options;
}

void expect_silent(const Found& found) {
  if (found.walls.thinnest)
    ADD_FAILURE() << "wall of " << found.walls.thinnest->spans << " spans near " << found.walls.thinnest->where[0]
                  << " " << found.walls.thinnest->where[1] << " " << found.walls.thinnest->where[2];
  EXPECT_EQ(found.walls.volume_share, 0);
  if (found.gap) ADD_FAILURE() << "gap of " << found.gap->spans << " spans near " << found.gap->where[0];
}

TEST(Walls, ATubeOfTwoMillimetresInSpansOfTen) {
  const TriangleMesh tube = ring(circle(30, 64), circle(28, 64), 100);
  for (const double shift : {0.0, 0.37}) {
    const Found found = measure(tube, spans_of(10, shift));
    ASSERT_TRUE(found.walls.thinnest);
    EXPECT_NEAR(found.walls.thinnest->thickness, 2, 0.01);
    EXPECT_NEAR(found.walls.thinnest->spans, 0.2, 0.001);
    EXPECT_NEAR(found.walls.thinnest->span_size, 1, 0.005);
    EXPECT_NEAR(std::hypot(found.walls.thinnest->where[0], found.walls.thinnest->where[1]), 29, 1.1);
    EXPECT_GT(found.walls.volume_share, 0.95);
    EXPECT_FALSE(found.gap); // the bore is 5.6 spans wide
  }
}

TEST(Walls, TwoSpansAreEnough) {
  expect_silent(measure(ring(circle(8, 48), circle(6, 48), 6), spans_of(1)));
  expect_silent(measure(box({0, 0, 0}, {8, 8, 2}), spans_of(1)));
  // Only across the wall the spans must be small.
  const TriangleMesh plate = box({0, 0, 0}, {20, 15, 2});
  expect_silent(measure(make_part(plate, SplineGrid({-10, -10, -2}, {30, 25, 4}, {8, 7, 6}, {2, 2, 2}))));
  const Found found = measure(make_part(plate, SplineGrid({-4, -4, -10}, {24, 20, 15}, {28, 24, 5}, {2, 2, 2})));
  ASSERT_TRUE(found.walls.thinnest);
  EXPECT_NEAR(found.walls.thinnest->spans, 0.4, 1e-9);
  EXPECT_NEAR(found.walls.thinnest->thickness, 2, 1e-9);
}

TEST(Walls, WantFourFunctionsAcross) {
  const TriangleMesh plate = box({0, 0, 0}, {8, 7, 2});
  for (const auto& [degree, enough, too_large] :
       {std::array{1, 66, 75}, std::array{2, 100, 110}, std::array{3, 200, 220}, std::array{4, 200, 220}}) {
    PartOptions options = spans_of(enough * 0.01);
    options.degree = degree;
    EXPECT_FALSE(measure(plate, options).walls.thinnest) << degree;
    options.span_size = too_large * 0.01;
    EXPECT_TRUE(measure(plate, options).walls.thinnest) << degree;
  }
}

TEST(Walls, ThickPartsWithEdgesAndCornersAreNoWalls) {
  const Rotation R = rotation(25, 40);
  for (const double shift : {0.0, 0.37}) {
    expect_silent(measure(box({0, 0, 0}, {10, 10, 10}), spans_of(2.5, shift)));
    expect_silent(measure(box({0, 0, 0}, {10, 10, 10}), spans_of(2.5, shift, R)));
    expect_silent(measure(sphere({0, 0, 0}, 10, 3), spans_of(2.5, shift)));
    // A wedge of 45 degrees.
    expect_silent(measure(prism({{0, 0}, {10, 0}, {10, 10}}, {{0, 1, 2}}, 0, 10), spans_of(2, shift)));
  }
}

TEST(Walls, AWedgeTapersToAnEdge) {
  const double length = 20, height = length * std::tan(20 * degrees);
  const Found found = measure(prism({{0, 0}, {length, 0}, {length, height}}, {{0, 1, 2}}, 0, 8), spans_of(1));
  ASSERT_TRUE(found.walls.thinnest);
  EXPECT_NEAR(found.walls.thinnest->taper, 20, 1e-6);
  EXPECT_GT(found.walls.thinnest->spans, 0.05);
  EXPECT_LT(found.walls.thinnest->spans, 0.5);
  EXPECT_LT(found.walls.thinnest->where[0], 2);
  // Thin up to the distance c from the edge on both faces: a kite of the area c² tan(10°).
  const double c = 1.9 / std::tan(20 * degrees);
  EXPECT_NEAR(found.walls.volume_share, c * c * std::tan(10 * degrees) / (0.5 * length * height), 0.02);
}

TEST(Walls, AHingeBetweenThickBlocksIsFound) {
  // Blocks of 4 × 4, joined by a web 1 long and 0.3 thick.
  const Found found = measure(
      prism({{0, 0}, {4, 0}, {4, 2}, {5, 2}, {5, 0}, {9, 0}, {9, 4}, {5, 4}, {5, 2.3}, {4, 2.3}, {4, 4}, {0, 4}},
            {{0, 1, 2},
             {0, 2, 9},
             {0, 9, 11},
             {9, 10, 11},
             {2, 3, 8},
             {2, 8, 9},
             {3, 4, 5},
             {3, 5, 8},
             {5, 6, 8},
             {6, 7, 8}},
            0, 6),
      spans_of(1));
  ASSERT_TRUE(found.walls.thinnest);
  EXPECT_NEAR(found.walls.thinnest->thickness, 0.3, 1e-9);
  EXPECT_NEAR(found.walls.thinnest->where[0], 4.5, 0.5);
  EXPECT_NEAR(found.walls.volume_share, 0.3 / (2 * 16 + 0.3), 0.006);
}

TEST(Walls, AThinPlateAtAnAngleKeepsItsThickness) {
  const Rotation R = rotation(25, 40);
  const Found found = measure(box({0, 0, 0}, {30, 20, 2}), spans_of(4, 0.37, R));
  ASSERT_TRUE(found.walls.thinnest);
  EXPECT_NEAR(found.walls.thinnest->thickness, 2, 1e-9);
  EXPECT_NEAR(found.walls.thinnest->spans, 0.5, 1e-9);
  EXPECT_GT(found.walls.volume_share, 0.9);
}

TEST(Gaps, BetweenTwoPlates) {
  const TriangleMesh plates = join({box({0, 0, 0}, {100, 60, 2}), box({0, 0, 3}, {100, 60, 5})});
  for (const double shift : {0.0, 0.37}) {
    const Found found = measure(plates, spans_of(5, shift));
    ASSERT_TRUE(found.gap);
    EXPECT_NEAR(found.gap->width, 1, 1e-9);
    EXPECT_NEAR(found.gap->spans, 0.2, 1e-9);
    EXPECT_NEAR(found.gap->span_size, 1.0 / 3, 1e-9);
    EXPECT_NEAR(found.gap->where[2], 2.5, 0.5 + 1e-9);
    ASSERT_TRUE(found.walls.thinnest);
    EXPECT_NEAR(found.walls.thinnest->spans, 0.4, 1e-9);
  }
}

TEST(Gaps, WithSpansOfTheAdvisedSizeThereIsNone) {
  const TriangleMesh plates = join({box({0, 0, 0}, {6, 5, 2}), box({0, 0, 2.9}, {6, 5, 5})});
  for (const Rotation& R : {identity_rotation, rotation(30, 20)}) {
    const Found coarse = measure(plates, spans_of(1, 0.37, R));
    ASSERT_TRUE(coarse.gap);
    EXPECT_NEAR(coarse.gap->width, 0.9, 1e-9);
    EXPECT_FALSE(measure(plates, spans_of(coarse.gap->span_size, 0.37, R)).gap);
  }
}

TEST(Gaps, AForksSlot) {
  const Found found = measure(fork(0.5, 8), spans_of(1));
  ASSERT_TRUE(found.gap);
  EXPECT_NEAR(found.gap->width, 0.5, 1e-9);
  EXPECT_GT(found.gap->where[1], 4 + 1.5 - 0.6); // the bottom connects what is nearer
  EXPECT_FALSE(found.walls.thinnest);
  EXPECT_TRUE(measure(fork(2, 8), spans_of(1)).gap);
  // Wide enough, or so shallow that the bottom connects the sides within any support.
  EXPECT_FALSE(measure(fork(3, 8), spans_of(1)).gap);
  EXPECT_FALSE(measure(fork(0.5, 1), spans_of(1)).gap);
}

// Plates of random thickness, gap and turn at p = 1 … 3: both are told exactly where they are below what is wanted.
TEST(WallsAndGaps, OfRandomPlatesAreRight) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (int k = 0; k < 24; ++k) {
    const int p = 1 + k % 3;
    const double thickness = uniform(0.3, 4), gap = std::pow(10, uniform(-1, 0.6));
    const Rotation R = k % 4 == 0 ? identity_rotation : rotation(uniform(0, 90), uniform(0, 90));
    PartOptions options = spans_of(1, uniform(0, 1), R);
    options.degree = p;
    const Found found = measure(
        join({box({0, 0, 0}, {8, 7, thickness}), box({0, 0, thickness + gap}, {8, 7, 2 * thickness + gap})}), options);
    SCOPED_TRACE(testing::Message() << "p = " << p << ", thickness " << thickness << ", gap " << gap);
    const double wanted = 0.95 * std::max(4 - p, 1);
    const double reach = gap / ((p + 1) * (std::abs(R[2][0]) + std::abs(R[2][1]) + std::abs(R[2][2])));
    EXPECT_EQ(found.walls.thinnest.has_value(), thickness < wanted);
    if (found.walls.thinnest) {
      EXPECT_NEAR(found.walls.thinnest->thickness, thickness, 1e-9);
    }
    EXPECT_EQ(found.gap.has_value(), reach < 0.75);
    if (found.gap) {
      EXPECT_NEAR(found.gap->width, gap, 1e-9);
      EXPECT_NEAR(found.gap->span_size, reach, 1e-9);
    }
  }
}

TEST(Gaps, BoresAndHollowsAreNone) {
  for (const double radius : {0.3, 1.0, 1.4}) {
    const TriangleMesh block = ring(square(5, 32), circle(radius, 32), 8);
    for (const Rotation& R : {identity_rotation, rotation(25, 40)})
      EXPECT_FALSE(measure(block, spans_of(1, 0.37, R)).gap);
  }
  expect_silent(
      measure(join({box({0, 0, 0}, {9, 9, 9}), flipped(box({3.5, 3.5, 3.5}, {5.5, 5.5, 5.5}))}), spans_of(1)));
}

} // namespace
} // namespace iga::prep
