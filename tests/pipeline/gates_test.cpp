#include "preprocessor/gates.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/make_grid.hpp"
#include "tests/support/small_surfaces.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using test::box_mesh;

template <class Work> std::string refusal(Work&& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
}

struct BoxInGrid : testing::Test {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 0.9, 0.7});
  SplineGrid grid = make_grid(mesh, {}).grid;
  double volume = volume_moments(mesh).volume;
};

TEST_F(BoxInGrid, AClosedSurfacePasses) {
  EXPECT_TRUE(judge_trimming(grid, trim(grid, mesh, {}), volume, false).empty());
}

TEST_F(BoxInGrid, AMissingTriangleIsRefusedWithPlaceAndOption) {
  mesh.triangles.erase(mesh.triangles.begin() + 9); // on the side x = 0
  mesh.region.pop_back();
  const auto trimming = trim(grid, mesh, {});
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume_moments(mesh).volume, false); }),
               {"leaks in", "row of span", "--repair", "--wrap", "--accept-leaks"});
  EXPECT_FALSE(judge_trimming(grid, trimming, volume_moments(mesh).volume, true).empty());
}

TEST_F(BoxInGrid, AWrongVolumeIsRefused) {
  const auto trimming = trim(grid, mesh, {});
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume * (1 + 1e-8), false); }),
               {"the spans hold", "--repair"});
  EXPECT_NO_THROW(judge_trimming(grid, trimming, volume * (1 + 1e-10), false));
}

TEST_F(BoxInGrid, APartWithinTheSliverDepthIsRefused) {
  auto trimming = trim(grid, mesh, {});
  trimming.snapped_volume = -2e-3 * volume;
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume, true); }),
               {"thinner", "--span-size", "--sliver-tolerance"});
}

TEST_F(BoxInGrid, ADroppedPartIsRefused) {
  GridOptions options;
  options.span_size = {3};
  grid = make_grid(mesh, options).grid;
  TrimOptions drop;
  drop.min_fraction = 0.5;
  expect_words(refusal([&] { judge_trimming(grid, trim(grid, mesh, drop), volume, false); }),
               {"no span", "--min-fraction"});
}

TEST(JudgeWinding, OverlapsAreRefusedEvenWhereLeaksAreAccepted) {
  WindingReport winding;
  winding.num_lines = 100;
  EXPECT_TRUE(judge_winding(winding, {}, false).empty());
  winding.bad_lines = 3;
  winding.worst_winding = 2;
  for (const bool accept : {false, true})
    expect_words(refusal([&] { judge_winding(winding, {}, accept); }), {"3 of 100", "worst 2", "--repair"});
  Trimming leaking;
  leaking.worst_leak = 0.1;
  EXPECT_EQ(judge_winding(winding, leaking, true).size(), 1U);
}

TEST(JudgeWinding, GluedFunctionsAreAWarning) {
  WindingReport winding;
  winding.glued_functions = 7;
  const auto warnings = judge_winding(winding, {}, false);
  ASSERT_EQ(warnings.size(), 1U);
  expect_words(warnings[0], {"7 function(s)", "glued"});
}

TEST(JudgeWeights, CountsSnappedAndDroppedVolume) {
  QuadratureInfo info;
  info.part_volume = 10;
  info.snapped_volume = 0.25;
  info.dropped_volume = 0.5;
  EXPECT_NO_THROW(judge_weights(9.75, info));
  expect_words(refusal([&] { judge_weights(9.75 * (1 + 1e-8), info); }), {"weights sum to", "--tolerance"});
}

TEST(PointMoments, OfGaussPointsEqualTheBoxs) {
  // Two points per direction integrate second moments exactly; in a turned grid far from the origin.
  const Rotation R{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  const Point3 A{1e4, 2e4, 3e4}, B{1e4 + 2, 2e4 + 3, 3e4 + 4};
  const SplineGrid grid(A, B, {1, 1, 1}, {1, 1, 1}, R);
  IntegrationPoints points;
  points.offsets = {0, 8};
  const double g = 0.5 / std::sqrt(3.0);
  for (int q = 0; q < 8; ++q) {
    for (int d = 0; d < 3; ++d) {
      const auto e = static_cast<std::size_t>(d);
      points.parameters.push_back(A[e] + (B[e] - A[e]) * (0.5 + ((q >> d) & 1 ? g : -g)));
    }
    points.weights.push_back(3);
  }
  const Point3 centre{1e4 + 1, 2e4 + 1.5, 3e4 + 2};
  const auto m = point_moments(grid, points, centre);
  EXPECT_DOUBLE_EQ(m.volume, 24);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(m.centroid[d], centre[d], 1e-10);
  // The grid's u axis points along y in space.
  EXPECT_NEAR(m.second_moments[0], 24 * 9 / 12.0, 1e-9);
  EXPECT_NEAR(m.second_moments[1], 24 * 4 / 12.0, 1e-9);
  EXPECT_NEAR(m.second_moments[2], 24 * 16 / 12.0, 1e-9);
  EXPECT_NEAR(m.second_moments[3], 0, 1e-9);
}

} // namespace
} // namespace iga::prep
