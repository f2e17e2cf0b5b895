#include "preprocessor/program/gates.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/trim/make_grid.hpp"
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

const SurfaceTreatment accepted{false, false, true};

struct BoxInGrid : testing::Test {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 0.9, 0.7});
  SplineGrid grid = make_grid(mesh, {}).grid;
  double volume = volume_moments(mesh).volume;
};

TEST_F(BoxInGrid, AClosedSurfacePasses) {
  EXPECT_TRUE(judge_trimming(grid, trim(grid, mesh, {}), volume, {}).empty());
}

TEST_F(BoxInGrid, AMissingTriangleIsRefusedWithPlaceAndOption) {
  mesh.triangles.erase(mesh.triangles.begin() + 9); // on the side x = 0
  mesh.region.pop_back();
  const auto trimming = trim(grid, mesh, {});
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume_moments(mesh).volume, {}); }),
               {"leaks in", "row of span", "--repair"});
  EXPECT_FALSE(judge_trimming(grid, trimming, volume_moments(mesh).volume, accepted).empty());
}

TEST_F(BoxInGrid, AWrongVolumeIsRefused) {
  const auto trimming = trim(grid, mesh, {});
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume * (1 + 1e-8), {}); }),
               {"the spans hold", "--repair"});
  EXPECT_NO_THROW(judge_trimming(grid, trimming, volume * (1 + 1e-10), {}));
}

TEST_F(BoxInGrid, APartWithinTheSliverDepthIsRefused) {
  auto trimming = trim(grid, mesh, {});
  trimming.snapped_volume = -2e-3 * volume;
  expect_words(refusal([&] { judge_trimming(grid, trimming, volume, accepted); }),
               {"thinner", "--span-size", "--sliver-tolerance"});
}

TEST_F(BoxInGrid, ADroppedPartIsRefused) {
  GridOptions options;
  options.span_size = {3};
  grid = make_grid(mesh, options).grid;
  TrimOptions drop;
  drop.min_fraction = 0.5;
  expect_words(refusal([&] { judge_trimming(grid, trim(grid, mesh, drop), volume, {}); }),
               {"no span", "--min-fraction"});
}

TEST(JudgeWinding, OverlapsAreRefusedEvenWhereLeaksAreAccepted) {
  WindingReport winding;
  winding.num_lines = 100;
  EXPECT_TRUE(judge_winding(winding, {}, {}).empty());
  winding.bad_lines = 3;
  winding.worst_winding = 2;
  for (const SurfaceTreatment& treatment : {SurfaceTreatment{}, accepted})
    expect_words(refusal([&] { judge_winding(winding, {}, treatment); }), {"3 of 100", "worst 2", "--repair"});
  Trimming leaking;
  leaking.worst_leak = 0.1;
  EXPECT_EQ(judge_winding(winding, leaking, accepted).size(), 1U);
}

TEST(JudgeWinding, LinesThatDoNotLeaveTellAnOpenSurface) {
  WindingReport winding;
  winding.num_lines = 100;
  winding.bad_lines = 4;
  winding.worst_winding = 1;
  expect_words(refusal([&] { judge_winding(winding, {}, {}); }), {"is open", "4 of 100", "--repair"});
  EXPECT_EQ(judge_winding(winding, {}, {false, false, true, true}).size(), 1U);
}

TEST(JudgeWinding, AdvisesTheNextStepAndNeverWhatWasTried) {
  WindingReport winding;
  winding.num_lines = winding.bad_lines = 1;
  const auto advice = [&](bool repair, bool wrapped) {
    return refusal([&] { judge_winding(winding, {}, {repair, wrapped, false}); });
  };
  EXPECT_NE(advice(false, false).find("Mend it with --repair"), std::string::npos);
  EXPECT_EQ(advice(false, false).find("--wrap"), std::string::npos);
  EXPECT_EQ(advice(true, false).find("with --repair"), std::string::npos);
  EXPECT_NE(advice(true, false).find("--wrap"), std::string::npos);
  for (const bool repair : {false, true}) {
    EXPECT_EQ(advice(repair, true).find("--repair"), std::string::npos);
    EXPECT_EQ(advice(repair, true).find("--wrap "), std::string::npos);
  }
}

const SplineGrid unit_spans({0, 0, 0}, {10, 10, 10}, {10, 10, 10}, {2, 2, 2});

TEST(JudgeCells, NamesAPlaceWherePiecesCannotBeTold) {
  CellTable cells;
  EXPECT_TRUE(judge_cells(cells, unit_spans).empty());
  cells.unclear_spans = 3;
  cells.first_unclear = unit_spans.span_number({1, 2, 3});
  const auto warnings = judge_cells(cells, unit_spans);
  ASSERT_EQ(warnings.size(), 1U);
  expect_words(warnings[0], {"3 spans", "near (1.5, 2.5, 3.5)", "move together"});
}

TEST(JudgeWalls, NamesTheSpanSizeThatWouldDo) {
  EXPECT_TRUE(judge_walls({}, unit_spans).empty());
  const auto warnings = judge_walls({ThinWall{0.4, 0.4, {1, 2, 3}, 0, 0.2, 8000}, 0.25}, unit_spans);
  ASSERT_EQ(warnings.size(), 1U);
  expect_words(warnings[0],
               {"25 % of the solid's volume", "0.4 thick, 0.4 spans, near (1, 2, 3)", "at most 0.2 ", "now 1 × 1 × 1"});
}

TEST(JudgeWalls, SizesThatNeedTooManySpansAreNotAdvised) {
  const auto warnings = judge_walls({ThinWall{1e-4, 1e-4, {}, 0, 5e-5, 8e12}, 1}, unit_spans);
  ASSERT_EQ(warnings.size(), 1U);
  expect_words(warnings[0], {"about 8e+12 spans", "across the wall only"});
  EXPECT_EQ(warnings[0].find("at most"), std::string::npos);
}

TEST(JudgeWalls, AnEdgeThatTapersOutGetsNoSpanSize) {
  const ThinWall edge{0.1, 0.1, {}, 20, 0.05, 500};
  EXPECT_TRUE(judge_walls({edge, 1e-4}, unit_spans).empty());
  const auto warnings = judge_walls({edge, 0.05}, unit_spans);
  ASSERT_EQ(warnings.size(), 1U);
  expect_words(warnings[0], {"edge of 20 degrees", "two span sizes"});
  EXPECT_EQ(warnings[0].find("at most"), std::string::npos);
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
