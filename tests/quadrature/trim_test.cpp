#include "preprocessor/trim/trim.hpp"

#include "format/model/span_state.hpp"
#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

SplineGrid unit_grid(std::int64_t n) {
  const auto size = static_cast<double>(n);
  return SplineGrid({0, 0, 0}, {size, size, size}, {n, n, n}, {2, 2, 2});
}

std::int64_t count(const Trimming& trimming, SpanState state) {
  return std::count(trimming.state.begin(), trimming.state.end(), static_cast<std::uint8_t>(state));
}

SpanState state_at(const SplineGrid& grid, const Trimming& trimming, const Index3& ijk) {
  return static_cast<SpanState>(trimming.state[static_cast<std::size_t>(grid.span_number(ijk))]);
}

void expect_volume(const SplineGrid& grid, const TriangleMesh& mesh, double tolerance = 1e-12) {
  const Trimming trimming = trim(grid, mesh, {});
  const double volume = volume_moments(mesh).volume;
  EXPECT_NEAR(trimming.exact_volume, volume, tolerance * volume);
  EXPECT_LT(trimming.worst_leak, 1e-11);
  EXPECT_EQ(trimming.num_leaks, 0);
  double sum = 0;
  for (const double fraction : trimming.fraction) sum += fraction;
  EXPECT_NEAR(sum * grid.span_volume() + trimming.snapped_volume - trimming.exact_volume + trimming.dropped_volume -
                  trimming.snapped_volume,
              0, 1e-4 * volume); // exact fractions are kept for snapped spans too
}

TEST(Trim, CubeOnGridPlanesIsInteriorOnly) {
  const SplineGrid grid = unit_grid(8);
  const Trimming trimming = trim(grid, box({2, 3, 1}, {5, 6, 7}), {});
  EXPECT_EQ(count(trimming, SpanState::Interior), 3 * 3 * 6);
  EXPECT_EQ(count(trimming, SpanState::Trimmed), 0);
  EXPECT_EQ(trimming.snapped_spans, 0);
  EXPECT_EQ(trimming.exact_volume, 54);
  EXPECT_EQ(trimming.worst_leak, 0);
}

TEST(Trim, CubeThatFillsTheGrid) {
  const SplineGrid grid = unit_grid(4);
  const Trimming trimming = trim(grid, box({0, 0, 0}, {4, 4, 4}), {});
  EXPECT_EQ(count(trimming, SpanState::Interior), 64);
  EXPECT_EQ(trimming.exact_volume, 64);
}

TEST(Trim, CubeOffGridPlanes) {
  const SplineGrid grid = unit_grid(8);
  const Trimming trimming = trim(grid, box({1.25, 1.5, 2}, {5.5, 6.75, 7}), {});
  EXPECT_NEAR(trimming.exact_volume, 4.25 * 5.25 * 5, 1e-12);
  EXPECT_EQ(count(trimming, SpanState::Interior), 3 * 4 * 5);
  EXPECT_EQ(count(trimming, SpanState::Trimmed), 5 * 6 * 5 - 60);
  for (std::size_t a = 0; a < trimming.active.size(); ++a) {
    const Index3 i = grid.span_index(trimming.active[a]);
    const double x = i[0] == 1 ? 0.75 : i[0] == 5 ? 0.5 : 1, y = i[1] == 1 ? 0.5 : i[1] == 6 ? 0.75 : 1;
    EXPECT_NEAR(trimming.fraction[a], x * y, 1e-15);
  }
}

TEST(Trim, VolumesOfRotatedCubesSpheresAndPlates) {
  for (int k = 0; k < 6; ++k) {
    const Rotation R = rotation(11.0 + 37 * k, 5.0 + 23 * k);
    const TriangleMesh cube = transformed(box({0, 0, 0}, {1, 1, 1}), R, {3, -2, 1});
    expect_volume(grid_around(cube, 0.13, 2, 0.1 * k), cube);
    const TriangleMesh ball = sphere({0.1, 0.2, 0.3}, 1, 4);
    expect_volume(grid_around(ball, 0.21 + 0.01 * k, 3, 0.1 * k), ball);
    const TriangleMesh plate = transformed(box({0, 0, 0}, {1, 1, 1e-3}), R, {});
    expect_volume(grid_around(plate, 0.11, 2, 0.1 * k), plate);
  }
}

TriangleMesh torus(double R, double r, int n) {
  TriangleMesh m;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double a = 2 * M_PI * i / n, b = 2 * M_PI * j / n;
      m.vertices.push_back({(R + r * std::cos(b)) * std::cos(a), (R + r * std::cos(b)) * std::sin(a), r * std::sin(b)});
      const int ni = (i + 1) % n, nj = (j + 1) % n;
      m.triangles.push_back({i * n + j, ni * n + j, ni * n + nj});
      m.triangles.push_back({i * n + j, ni * n + nj, i * n + nj});
    }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"torus"};
  return m;
}

TEST(Trim, TorusWhoseVerticesLieInGridPlanes) {
  const TriangleMesh mesh = torus(3, 1, 40);
  ASSERT_NEAR(volume_moments(mesh).volume, 2 * M_PI * M_PI * 3, 0.6);
  const SplineGrid on({-5, -5, -2}, {5, 5, 2}, {20, 20, 8}, {2, 2, 2});
  expect_volume(on, mesh);
  expect_volume(grid_around(mesh, 0.37, 2, 0.3), mesh);
}

TEST(Trim, CavityIsExterior) {
  const TriangleMesh mesh = join(
      {box({1, 1, 1}, {9, 9, 9}), flipped(transformed(box({-2, -2, -2}, {2, 2, 2}), rotation(20, 30), {5, 5, 5}))});
  const SplineGrid grid = unit_grid(10);
  const Trimming trimming = trim(grid, mesh, {});
  EXPECT_NEAR(trimming.exact_volume, 512 - 64, 1e-11);
  EXPECT_EQ(state_at(grid, trimming, {5, 5, 5}), SpanState::Exterior);
  EXPECT_EQ(state_at(grid, trimming, {1, 1, 1}), SpanState::Interior);
}

TEST(Trim, SliversAreSnappedByDepthBothWays) {
  const SplineGrid grid = unit_grid(6);
  // Sticks out by 1e-5 in x, falls short by 1e-5 in y: both shallower than the default depth.
  const Trimming trimming = trim(grid, box({1, 1, 1}, {4 + 1e-5, 4 - 1e-5, 4}), {});
  EXPECT_EQ(count(trimming, SpanState::Interior), 27);
  EXPECT_EQ(count(trimming, SpanState::Trimmed), 0);
  EXPECT_NEAR(trimming.exact_volume, (3 + 1e-5) * (3 - 1e-5) * 3, 1e-12);
  EXPECT_NEAR(trimming.exact_volume + trimming.snapped_volume, 27, 1e-12);
  EXPECT_EQ(trimming.snapped_spans, 3 * 3 + 3 * 3); // beyond x = 4, and the last layer in y
}

TEST(Trim, CornerOfSmallVolumeButRealDepthIsKept) {
  // A tetrahedral corner of depth 1e-4 in every direction: its volume is 1.7e-13 of the span.
  const double d = 1e-4;
  TriangleMesh mesh;
  mesh.vertices = {{2 - 1, 2 - 1, 2 - 1}, {2 + 3 + d, 1, 1}, {1, 2 + 3 + d, 1}, {1, 1, 2 + 3 + d}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.region.assign(4, 0);
  mesh.region_names = {"corner"};
  const SplineGrid grid = unit_grid(8);
  const Trimming trimming = trim(grid, mesh, {});
  EXPECT_EQ(state_at(grid, trimming, {5, 1, 1}), SpanState::Trimmed);
  const auto a = std::find(trimming.active.begin(), trimming.active.end(), grid.span_number({5, 1, 1}));
  ASSERT_NE(a, trimming.active.end());
  EXPECT_NEAR(trimming.fraction[static_cast<std::size_t>(a - trimming.active.begin())], d * d * d / 6,
              1e-10 * d * d * d);
  EXPECT_NEAR(trimming.exact_volume, std::pow(4 + d, 3) / 6, 1e-12);
}

TEST(Trim, MinimumFractionDropsAndRecords) {
  const SplineGrid grid = unit_grid(6);
  TrimOptions options;
  options.min_fraction = 0.02;
  const Trimming trimming = trim(grid, box({1, 1, 1}, {4.01, 4.5, 4}), options);
  EXPECT_EQ(trimming.dropped_spans, 4 * 3);
  EXPECT_NEAR(trimming.dropped_volume, 0.01 * 3.5 * 3, 1e-13);
  EXPECT_NEAR(trimming.exact_volume, 3.01 * 3.5 * 3, 1e-12);
  EXPECT_EQ(state_at(grid, trimming, {4, 1, 1}), SpanState::Exterior);
  EXPECT_EQ(state_at(grid, trimming, {1, 4, 1}), SpanState::Trimmed);
}

TEST(Trim, OpenCubeLeaksAndSaysWhere) {
  TriangleMesh mesh = box({1.25, 1.25, 1.25}, {4.75, 4.75, 4.75});
  mesh.triangles.pop_back();
  mesh.region.pop_back();
  const Trimming trimming = trim(unit_grid(6), mesh, {});
  EXPECT_GT(trimming.num_leaks, 0);
  ASSERT_FALSE(trimming.leaks.empty());
  EXPECT_GE(trimming.worst_leak, trimming.leaks.front().error);
  EXPECT_TRUE(std::is_sorted(trimming.leaks.begin(), trimming.leaks.end(),
                             [](const Leak& a, const Leak& b) { return a.error > b.error; }));
  // Every side of the cube that can go missing is seen, whatever axis it faces.
  const TriangleMesh whole = box({1.25, 1.25, 1.25}, {4.75, 4.75, 4.75});
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    TriangleMesh open = whole;
    open.triangles.erase(open.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    open.region.pop_back();
    EXPECT_GT(trim(unit_grid(6), open, {}).worst_leak, 0.01) << "without triangle " << t;
  }
}

TEST(Trim, CoincidentSheetsInsideASpanLeaveItWhole) {
  const SplineGrid grid = unit_grid(4);
  const Trimming trimming = trim(grid, join({box({1, 1, 1}, {1.5, 2, 2}), box({1.5, 1, 1}, {3, 2, 2})}), {});
  EXPECT_NEAR(trimming.exact_volume, 2, 1e-15);
  EXPECT_EQ(count(trimming, SpanState::Exterior), 64 - 2);
}

} // namespace
} // namespace iga::prep
