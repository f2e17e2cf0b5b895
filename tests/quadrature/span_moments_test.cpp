// Moments of single spans against half-space cuts in extended precision.
#include "preprocessor/fit/span_moments.hpp"

#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/convex_solid.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

struct Coverage {
  int spans = 0, all_crossed = 0, full = 0, empty = 0, thin = 0;
};

// All touched spans of a convex solid in the grid. The clipping rounds positions at about one unit in the last place of
// the grid's extent; in box units, that much times the surface is what a moment may be off by.
void compare(const SplineGrid& grid, const TriangleMesh& mesh, const std::array<int, 3>& degree, Coverage& seen,
             int at_most = 40) {
  const Trimming trimming = trim(grid, mesh, {});
  const FarMoments far(grid, trimming, degree);
  const auto planes = half_spaces(to_span_units(grid, mesh), mesh.triangles);
  const Index3 n = grid.spans();
  const double ulp = 4.4e-16 * static_cast<double>(std::max({n[0], n[1], n[2]}));
  LocalSurface local;
  std::vector<double> moments(static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1)));
  const std::size_t step = std::max<std::size_t>(1, trimming.pieces.spans.size() / static_cast<std::size_t>(at_most));
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); t += step) {
    if (trimming.touched_fraction[t] <= 1e-14) continue;
    gather_local_surface(grid, trimming, t, local);
    span_moments(local, far.find(t), degree, moments.data());
    Polyhedron solid = cube_of(local.span);
    for (const HalfSpace& plane : planes) solid = cut(solid, plane);
    Box3 box = local.box;
    double smallest = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] += static_cast<double>(local.span[d]);
      box.upper[d] += static_cast<double>(local.span[d]);
      smallest = std::min(smallest, box.upper[d] - box.lower[d]);
    }
    const auto exact = legendre_moments(solid, box, degree);
    for (std::size_t k = 0; k < moments.size(); ++k)
      ASSERT_NEAR(moments[k], static_cast<double>(exact[k]), 20 * ulp / smallest)
          << "span " << local.span[0] << " " << local.span[1] << " " << local.span[2] << " moment " << k << " of "
          << moments[0];
    const auto has = [&](FaceState s) { return std::count(local.faces.begin(), local.faces.end(), s); };
    ++seen.spans;
    seen.all_crossed += has(FaceState::Crossed) == 6;
    seen.full += has(FaceState::Full) > 0 && has(FaceState::Empty) == 0;
    seen.empty += has(FaceState::Empty) > 0;
    seen.thin += moments[0] < 1e-2;
  }
}

TEST(SpanMoments, RotatedCubesOfAllDegrees) {
  Coverage seen;
  for (int k = 0; k < 4; ++k) {
    const TriangleMesh mesh = transformed(box({0, 0, 0}, {1, 1, 1}), rotation(13.0 + 41 * k, 8.0 + 29 * k), {});
    const SplineGrid grid = grid_around(mesh, 0.23, 2, 0.17 * k);
    compare(grid, mesh, {2, 2, 2}, seen);
    compare(grid, mesh, {1, 2, 4}, seen, 12);
    compare(grid, mesh, {3, 3, 3}, seen, 8);
    compare(grid, mesh, {4, 4, 4}, seen, 8);
  }
  EXPECT_GT(seen.empty, 20);
  EXPECT_GT(seen.full, 10);
}

TEST(SpanMoments, TwiceTheDegree) {
  Coverage seen;
  const TriangleMesh mesh = transformed(box({0, 0, 0}, {1, 1, 1}), rotation(27, 18), {});
  const SplineGrid grid = grid_around(mesh, 0.4, 2, 0.3);
  compare(grid, mesh, {6, 6, 6}, seen, 6);
  compare(grid, mesh, {8, 8, 8}, seen, 3);
  EXPECT_GT(seen.spans, 6);
}

// A sheet across all six faces of a span leaves no face that is known: the moments come from the far side of the row.
TEST(SpanMoments, AllSixFacesCrossed) {
  Coverage seen;
  for (const double thickness : {0.6, 0.05, 1e-3}) {
    // Normal to (1, 1, 1): planes through the spans' centres cross all faces.
    const TriangleMesh mesh =
        transformed(box({-3, -3, -thickness / 2}, {3, 3, thickness / 2}), rotation(45, 54.735610317245346), {0, 0, 0});
    const SplineGrid grid = grid_around(mesh, 1, 2, 0.5);
    compare(grid, mesh, {2, 2, 2}, seen, 1000);
    compare(grid, mesh, {4, 4, 4}, seen, 10);
  }
  EXPECT_GT(seen.all_crossed, 5);
  EXPECT_GT(seen.thin, 5);
}

TEST(SpanMoments, TinyCornersAndNeedles) {
  Coverage seen;
  for (int k = 0; k < 6; ++k) {
    const double thin = std::pow(10.0, -1 - 0.5 * k);
    const TriangleMesh needle =
        transformed(box({0, 0, 0}, {1, 0.2 * thin, 0.3 * thin}), rotation(19.0 + 31 * k, 7.0 + 13 * k), {});
    compare(grid_around(needle, 0.19, 2, 0.1 * k), needle, {3, 3, 3}, seen, 8);
    const TriangleMesh wedge =
        transformed(prism({{0, 0}, {1, 0}, {1, thin}}, {{0, 1, 2}}, 0, 1), rotation(9.0 + 31 * k, 17.0 + 13 * k), {});
    compare(grid_around(wedge, 0.29, 2, 0.1 * k), wedge, {2, 2, 2}, seen, 8);
  }
  EXPECT_GT(seen.thin, 10);
}

// What a cavity leaves is what the cavity takes away from the whole span.
TEST(SpanMoments, CavityIsTheDifference) {
  const TriangleMesh hole = transformed(box({-1.6, -1.6, -1.6}, {1.6, 1.6, 1.6}), rotation(20, 30), {5.1, 5.2, 5.3});
  const TriangleMesh mesh = join({box({1, 1, 1}, {9, 9, 9}), flipped(hole)});
  const SplineGrid grid({0, 0, 0}, {10, 10, 10}, {10, 10, 10}, {2, 2, 2});
  const Trimming trimming = trim(grid, mesh, {});
  const std::array<int, 3> degree{3, 2, 4};
  const FarMoments far(grid, trimming, degree);
  const auto planes = half_spaces(to_span_units(grid, hole), hole.triangles);
  LocalSurface local;
  std::vector<double> moments(60);
  int compared = 0;
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); ++t) {
    const double fraction = trimming.touched_fraction[t];
    if (fraction < 1e-3 || fraction > 1 - 1e-3) continue;
    gather_local_surface(grid, trimming, t, local);
    span_moments(local, far.find(t), degree, moments.data());
    Box3 box = local.box;
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] += static_cast<double>(local.span[d]);
      box.upper[d] += static_cast<double>(local.span[d]);
    }
    Polyhedron whole = cube_of(local.span); // within the box: outside, the polynomials grow and cancel
    for (std::size_t d = 0; d < 3; ++d) {
      Long3 n{};
      n[d] = 1;
      whole = cut(whole, {n, box.upper[d]});
      n[d] = -1;
      whole = cut(whole, {n, -box.lower[d]});
    }
    Polyhedron taken = whole;
    for (const HalfSpace& plane : planes) taken = cut(taken, plane);
    const auto all = legendre_moments(whole, box, degree), less = legendre_moments(taken, box, degree);
    for (std::size_t k = 0; k < moments.size(); ++k)
      ASSERT_NEAR(moments[k], static_cast<double>(all[k] - less[k]), 1e-11) << t << " " << k;
    ++compared;
  }
  EXPECT_GT(compared, 30);
}

} // namespace
} // namespace iga::prep
