#include "preprocessor/quadrature/surface_quadrature.hpp"

#include "format/model/errors.hpp"
#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace iga::prep {
namespace {

using namespace iga::test;

struct Integrals {
  std::vector<double> area; // per region
  Point3 closure{};         // Σ n w
  double flux = 0;          // Σ (x - c)·n w
};

Integrals integrate(const SplineGrid& grid, const EmbeddedSurface& s) {
  Integrals sums;
  sums.area.assign(s.mesh.region_names.size(), 0);
  const auto& q = s.quadrature;
  const Point3 c = s.mesh.vertices[0];
  for (std::size_t a = 0; a < q.weights.size(); ++a) {
    const Point3 x = grid.to_position({q.parameters[3 * a], q.parameters[3 * a + 1], q.parameters[3 * a + 2]});
    sums.area[static_cast<std::size_t>(s.mesh.region[static_cast<std::size_t>(q.triangle[a])])] += q.weights[a];
    for (std::size_t d = 0; d < 3; ++d) {
      sums.closure[d] += q.normals[3 * a + d] * q.weights[a];
      sums.flux += (x[d] - c[d]) * q.normals[3 * a + d] * q.weights[a];
    }
  }
  return sums;
}

// Everything that has to hold for any surface; returns the relative error of Σ x·n w against three times the volume.
double expect_sound(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                    const EmbeddedSurface& s) {
  const auto& q = s.quadrature;
  const auto& active = trimming.active;
  EXPECT_EQ(q.offsets.size(), active.size() + 1);
  EXPECT_EQ(static_cast<std::size_t>(q.offsets.back()), q.weights.size());
  EXPECT_TRUE(std::all_of(q.weights.begin(), q.weights.end(), [](double w) { return w > 0; }));
  const auto outside = [&](std::int64_t span, const double* u) {
    const Box3 box = grid.span_box(grid.span_index(span));
    for (std::size_t d = 0; d < 3; ++d)
      if (!(u[d] >= box.lower[d] && u[d] <= box.upper[d])) return true;
    return false;
  };
  int misplaced = 0;
  for (std::size_t a = 0; a < active.size(); ++a)
    for (auto p = q.offsets[a]; p < q.offsets[a + 1]; ++p)
      misplaced += outside(active[a], &q.parameters[3 * static_cast<std::size_t>(p)]);
  for (std::size_t v = 0; v < s.vertex_cell.size(); ++v) {
    misplaced += outside(active[static_cast<std::size_t>(s.vertex_cell[v])], &s.vertex_parameters[3 * v]);
  }
  EXPECT_EQ(misplaced, 0);

  const Integrals sums = integrate(grid, s);
  std::vector<double> area(mesh.region_names.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh one{mesh.vertices, {mesh.triangles[t]}, {0}, {""}};
    area[static_cast<std::size_t>(mesh.region[t])] += surface_area(one);
  }
  for (std::size_t r = 0; r < area.size(); ++r) EXPECT_NEAR(sums.area[r], area[r], 1e-12 * area[r]);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(sums.closure[d], 0, 1e-12 * surface_area(mesh));
  const double volume = volume_moments(mesh).volume;
  return (sums.flux - 3 * volume) / (3 * volume);
}

double run(const SplineGrid& grid, const TriangleMesh& mesh, const TrimOptions& options = {},
           SurfaceRule rule = SurfaceRule::Exact) {
  const Trimming trimming = trim(grid, mesh, options);
  return expect_sound(grid, mesh, trimming, make_embedded_surface(grid, mesh, trimming, rule));
}

class SurfaceQuadrature : public testing::TestWithParam<int> {};

TEST_P(SurfaceQuadrature, ReproducesAreaClosureAndVolumeForGenericPlacements) {
  const TriangleMesh ball = sphere({0.3, -0.2, 0.1}, 1.0, 3);
  EXPECT_NEAR(run(grid_around(ball, 0.23, GetParam(), 0.31), ball), 0, 1e-12);
  const TriangleMesh cube = transformed(box({0, 0, 0}, {1, 2, 0.5}), rotation(30, 20), {3, 1, 2});
  EXPECT_NEAR(run(grid_around(cube, 0.17, GetParam(), 0.41), cube), 0, 1e-12);
  EXPECT_NEAR(run(grid_around(cube, 0.17, GetParam(), 0.41, rotation(-12, 47)), cube), 0, 1e-12);
}

TEST_P(SurfaceQuadrature, ReducedRulesReproduceThemToo) {
  const TriangleMesh cube = transformed(box({0, 0, 0}, {1, 2, 0.5}), rotation(30, 20), {3, 1, 2});
  for (const double shift : {0.0, 0.41})
    EXPECT_NEAR(run(grid_around(cube, 0.17, GetParam(), shift), cube, {}, SurfaceRule::Reduced), 0, 1e-12);
  const TriangleMesh aligned = box({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {8, 8, 8}, {GetParam(), GetParam(), GetParam()});
  const Trimming trimming = trim(grid, aligned, {});
  const EmbeddedSurface s = make_embedded_surface(grid, aligned, trimming, SurfaceRule::Reduced);
  EXPECT_NEAR(expect_sound(grid, aligned, trimming, s), 0, 1e-13);
  const TriangleMesh ball = sphere({0.3, -0.2, 0.1}, 1.0, 5); // facets of a tenth of a span
  const SplineGrid around = grid_around(ball, 0.5, GetParam(), 0.31);
  const Trimming cut = trim(around, ball, {});
  EXPECT_NEAR(run(around, ball, {}, SurfaceRule::Reduced), 0, 1e-12);
  const std::size_t points = make_embedded_surface(around, ball, cut, SurfaceRule::Reduced).quadrature.weights.size();
  EXPECT_LE(points, static_cast<std::size_t>(cut.pieces.num_pieces())); // one on each
}

TEST_P(SurfaceQuadrature, IntegratesPolynomialsUpToThreeTimesTheDegree) {
  const int p = GetParam();
  const TriangleMesh cube = box({0.13, 0.21, 0.08}, {0.83, 0.91, 0.78});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {p, p, p});
  const EmbeddedSurface s = make_embedded_surface(grid, cube, trim(grid, cube, {}));
  for (int a = 0; a <= 3 * p; ++a) {
    const int b = 3 * p - a;
    double sum = 0; // ∫ x^a y^b over the faces z = const
    for (std::size_t q = 0; q < s.quadrature.weights.size(); ++q)
      if (std::abs(s.quadrature.normals[3 * q + 2]) > 0.5)
        sum += s.quadrature.weights[q] * std::pow(s.quadrature.parameters[3 * q], a) *
               std::pow(s.quadrature.parameters[3 * q + 1], b);
    const double x = (std::pow(0.83, a + 1) - std::pow(0.13, a + 1)) / (a + 1);
    const double y = (std::pow(0.91, b + 1) - std::pow(0.21, b + 1)) / (b + 1);
    EXPECT_NEAR(sum, 2 * x * y, 1e-13) << a << ' ' << b;
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, SurfaceQuadrature, testing::Range(1, 5));

TEST(SurfaceOwner, FacesInGridPlanesGoToTheMaterialSide) {
  const TriangleMesh cube = box({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {8, 8, 8}, {2, 2, 2});
  const Trimming trimming = trim(grid, cube, {});
  ASSERT_EQ(trimming.active.size(), 64U);
  const EmbeddedSurface s = make_embedded_surface(grid, cube, trimming);
  EXPECT_NEAR(expect_sound(grid, cube, trimming, s), 0, 1e-14);
  // A span at a corner of the cube owns three faces of its own, one inside the cube none.
  const auto num_points = [&](const Index3& ijk) {
    const auto a = std::lower_bound(trimming.active.begin(), trimming.active.end(), grid.span_number(ijk)) -
                   trimming.active.begin();
    return s.quadrature.offsets[static_cast<std::size_t>(a) + 1] - s.quadrature.offsets[static_cast<std::size_t>(a)];
  };
  EXPECT_EQ(num_points({3, 3, 3}), 0);
  EXPECT_GT(num_points({5, 5, 5}), 0);
  EXPECT_GT(num_points({2, 2, 2}), 0);
}

TEST(SurfaceOwner, PrefersTheMaterialSideAlsoWhereTheOtherSideIsActive) {
  // Two boxes touch in the grid plane x = 0.5: each keeps its own face.
  const TriangleMesh two = join({box({0.2, 0.2, 0.2}, {0.5, 0.8, 0.8}), box({0.5, 0.2, 0.2}, {0.8, 0.8, 0.8})});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {4, 4, 4}, {2, 2, 2});
  const Trimming trimming = trim(grid, two, {});
  const EmbeddedSurface s = make_embedded_surface(grid, two, trimming);
  EXPECT_NEAR(expect_sound(grid, two, trimming, s), 0, 1e-14);
  for (std::size_t a = 0; a < trimming.active.size(); ++a)
    for (auto q = s.quadrature.offsets[a]; q < s.quadrature.offsets[a + 1]; ++q) {
      const auto p = static_cast<std::size_t>(q);
      if (s.quadrature.parameters[3 * p] != 0.5) continue;
      EXPECT_EQ(grid.span_index(trimming.active[a])[0], s.quadrature.normals[3 * p] > 0 ? 1 : 2);
    }
}

TEST(SurfaceOwner, FacesInTheGridsOwnBoundaryAreOwnedByTheLastSpans) {
  const TriangleMesh cube = box({0, 0, 0}, {1, 1, 1});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {2, 2, 2});
  EXPECT_NEAR(run(grid, cube), 0, 1e-14);
}

TEST(SurfaceOwner, SnappedPiecesMoveByTheSliverDepthAtMost) {
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {8, 8, 8}, {2, 2, 2});
  for (const double depth : {1e-6, -1e-6}) { // in lengths: 8e-6 spans into the next spans, or short of the plane
    const TriangleMesh cube =
        box({0.25 - depth, 0.25 - depth, 0.25 - depth}, {0.75 + depth, 0.75 + depth, 0.75 + depth});
    const Trimming trimming = trim(grid, cube, {});
    ASSERT_EQ(trimming.active.size(), 64U);
    ASSERT_GT(trimming.snapped_spans, 0);
    const EmbeddedSurface s = make_embedded_surface(grid, cube, trimming);
    const double error = expect_sound(grid, cube, trimming, s);
    EXPECT_LE(std::abs(error) * 3 * volume_moments(cube).volume, std::abs(depth) * surface_area(cube) * (1 + 1e-6));
    for (std::size_t v = 0; v < cube.vertices.size(); ++v)
      for (std::size_t d = 0; d < 3; ++d)
        EXPECT_NEAR(s.vertex_parameters[3 * v + d], cube.vertices[v][d], std::abs(depth) + 1e-15);
  }
}

TEST(SurfaceOwner, PiecesOfDroppedSpansGoToTheNearestActiveSpan) {
  const TriangleMesh cube = transformed(box({-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4}), rotation(30, 20), {1, 1, 1});
  const SplineGrid grid = grid_around(cube, 0.21, 2, 0.2);
  TrimOptions options;
  options.min_fraction = 0.3;
  const Trimming trimming = trim(grid, cube, options);
  ASSERT_GT(trimming.dropped_spans, 0);
  const EmbeddedSurface s = make_embedded_surface(grid, cube, trimming);
  EXPECT_LT(std::abs(expect_sound(grid, cube, trimming, s)), 0.3);
  for (std::size_t v = 0; v < cube.vertices.size(); ++v)
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.vertex_parameters[3 * v + d], cube.vertices[v][d], 2 * 0.21);
}

TEST(SurfaceOwner, RefusesAPartOfSliversOnly) {
  const TriangleMesh sheet = box({0.25, 0.25, 0.5}, {0.75, 0.75, 0.5 + 1e-7});
  const SplineGrid grid({0, 0, 0}, {1, 1, 1}, {4, 4, 4}, {2, 2, 2});
  const Trimming trimming = trim(grid, sheet, {});
  ASSERT_TRUE(trimming.active.empty());
  EXPECT_THROW(make_embedded_surface(grid, sheet, trimming), InputError);
}

TEST(SurfaceOwner, DependsNeitherOnScaleNorOnPlace) {
  const TriangleMesh ball = sphere({0.3, -0.2, 0.1}, 1.0, 3);
  const SplineGrid grid = grid_around(ball, 0.23, 2, 0.31);
  const EmbeddedSurface reference = make_embedded_surface(grid, ball, trim(grid, ball, {}));
  for (const double scale : {1e-6, 1e6})
    for (const double shift : {0.0, 1e4}) {
      TriangleMesh moved = ball;
      for (Point3& v : moved.vertices)
        for (double& c : v) c = scale * (c + shift);
      const SplineGrid moved_grid = grid_around(moved, 0.23 * scale, 2, 0.31);
      const Trimming trimming = trim(moved_grid, moved, {});
      const EmbeddedSurface s = make_embedded_surface(moved_grid, moved, trimming);
      EXPECT_NEAR(expect_sound(moved_grid, moved, trimming, s), 0, 1e-10); // 1e4 sizes away leave 12 digits of position
      EXPECT_EQ(s.vertex_cell, reference.vertex_cell);
      EXPECT_EQ(s.quadrature.offsets, reference.quadrature.offsets);
    }
}

TEST(SurfaceQuadratureParallel, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh ball = sphere({0, 0, 0}, 1.0, 4);
  const SplineGrid grid = grid_around(ball, 0.11, 2, 0.3);
  const Trimming trimming = trim(grid, ball, {});
  const EmbeddedSurface many = make_embedded_surface(grid, ball, trimming);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const EmbeddedSurface single = make_embedded_surface(grid, ball, trimming);
  EXPECT_EQ(many.quadrature.parameters, single.quadrature.parameters);
  EXPECT_EQ(many.quadrature.weights, single.quadrature.weights);
  EXPECT_EQ(many.quadrature.triangle, single.quadrature.triangle);
  EXPECT_EQ(many.vertex_cell, single.vertex_cell);
}

TEST(SurfaceQuadratureParts, HoldsForSharedParts) {
  if (shared_part("valid").empty()) GTEST_SKIP() << "shared STL parts are absent";
  for (const char* name : {"elephant.stl", "busted.STL", "plate_rot_t0.005.stl", "cube_theta0_aligned.stl",
                           "7_8ths_cube.stl", "large_block_obb.STL", "Spool_Holder_x1.STL"}) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = read_stl(shared_part(std::string("valid/") + name));
    const SplineGrid grid = grid_with(mesh, 15, 2);
    const Trimming trimming = trim(grid, mesh, {});
    const EmbeddedSurface s = make_embedded_surface(grid, mesh, trimming);
    const double error = expect_sound(grid, mesh, trimming, s);
    const double shift = trimming.snapped_spans > 0 ? 2e-5 * grid.span_size()[0] * surface_area(mesh) : 0;
    EXPECT_LE(std::abs(error) * 3 * volume_moments(mesh).volume, 1e-12 * 3 * volume_moments(mesh).volume + shift);
  }
}

} // namespace
} // namespace iga::prep
