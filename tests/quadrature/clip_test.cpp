#include "preprocessor/trim/clip.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "tests/embed/surfaces.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>

namespace iga::prep {
namespace {

using namespace iga::test;

// Grid of unit spans from the origin: span units are positions.
SplineGrid unit_grid(const Index3& n) {
  return SplineGrid({0, 0, 0}, {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}, n,
                    {2, 2, 2});
}

Point3 area_of(std::span<const Point3> v) {
  Point3 n{};
  for (std::size_t a = 1; a + 1 < v.size(); ++a)
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
      n[d] += 0.5 * ((v[a][e] - v[0][e]) * (v[a + 1][f] - v[0][f]) - (v[a][f] - v[0][f]) * (v[a + 1][e] - v[0][e]));
    }
  return n;
}

TriangleMesh random_triangles(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, size);
  TriangleMesh mesh;
  for (int t = 0; t < count; ++t) {
    for (int a = 0; a < 3; ++a) mesh.vertices.push_back({place(random), place(random), place(random)});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"soup"};
  return mesh;
}

void expect_sound(const SplineGrid& grid, const TriangleMesh& mesh, const SurfacePieces& pieces) {
  std::vector<Point3> sum(mesh.triangles.size(), Point3{});
  for (std::size_t t = 0; t < pieces.spans.size(); ++t) {
    if (t) {
      EXPECT_LT(pieces.spans[t - 1], pieces.spans[t]);
    }
    const Index3 ijk = grid.span_index(pieces.spans[t]);
    for (std::int64_t q = pieces.offsets[t]; q < pieces.offsets[t + 1]; ++q) {
      const auto v = pieces.polygon(q);
      ASSERT_GE(v.size(), 3u);
      ASSERT_LE(v.size(), 9u);
      if (q > pieces.offsets[t]) {
        EXPECT_LE(pieces.triangle[static_cast<std::size_t>(q - 1)], pieces.triangle[static_cast<std::size_t>(q)]);
      }
      for (const Point3& x : v)
        for (std::size_t d = 0; d < 3; ++d) {
          ASSERT_GE(x[d], static_cast<double>(ijk[d]));
          ASSERT_LE(x[d], static_cast<double>(ijk[d] + 1));
        }
      const Point3 area = area_of(v);
      for (std::size_t d = 0; d < 3; ++d)
        sum[static_cast<std::size_t>(pieces.triangle[static_cast<std::size_t>(q)])][d] += area[d];
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Point3, 3> corner;
    for (std::size_t a = 0; a < 3; ++a) corner[a] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][a])];
    const Point3 whole = area_of(corner);
    const double scale = std::hypot(whole[0], whole[1], whole[2]) + 1;
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(sum[t][d], whole[d], 1e-13 * scale) << "triangle " << t;
  }
}

// Every edge of every piece is met by the same edge in the other direction, to the bit.
void expect_closed(const SurfacePieces& pieces) {
  std::map<std::pair<Point3, Point3>, int> open;
  for (std::int64_t q = 0; q < pieces.num_pieces(); ++q) {
    const auto v = pieces.polygon(q);
    for (std::size_t a = 0; a < v.size(); ++a) {
      const Point3 &x = v[a], &y = v[(a + 1) % v.size()];
      if (x == y) continue;
      if (x < y)
        ++open[{x, y}];
      else
        --open[{y, x}];
    }
  }
  std::int64_t unmatched = 0;
  for (const auto& [edge, count] : open) unmatched += std::abs(count);
  EXPECT_EQ(unmatched, 0);
}

TEST(Clip, LosesNothingOfTrianglesThatRoundIntoAGridPlane) {
  // Triangles that reach a grid plane from less than 1e-14 below it: cut by the other planes, a part may round into it.
  const SplineGrid grid = unit_grid({30, 30, 30});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(5, 20), depth(0, 8e-15);
  for (std::size_t d = 0; d < 3; ++d)
    for (int i = 0; i < 300; ++i) {
      TriangleMesh mesh = random_triangles(1, 20, static_cast<unsigned>(i));
      for (Point3& x : mesh.vertices) x = {place(random), place(random), place(random)};
      for (std::size_t a = 0; a < 3; ++a) mesh.vertices[a][d] = a == 0 ? 22 : 22 - depth(random);
      const SurfacePieces pieces = clip_to_spans(grid, mesh);
      double sum = 0;
      for (std::int64_t q = 0; q < pieces.num_pieces(); ++q) sum += norm(area_of(pieces.polygon(q)));
      const double area = norm(area_of(mesh.vertices));
      EXPECT_NEAR(sum, area, 1e-12 * (1 + area)) << "triangle " << i << ", axis " << d;
    }
}

TEST(Clip, PiecesOfRandomTrianglesAddUpInsideTheirSpans) {
  const SplineGrid grid = unit_grid({7, 7, 7});
  const TriangleMesh mesh = random_triangles(200, 7, 1);
  expect_sound(grid, mesh, clip_to_spans(grid, mesh));
}

TEST(Clip, TriangleAcrossThousandsOfSpans) {
  const SplineGrid grid = unit_grid({64, 64, 64});
  TriangleMesh mesh = random_triangles(1, 64, 2);
  mesh.vertices = {{0.3, 0.2, 0.1}, {63.7, 11.4, 57.2}, {5.5, 63.2, 43.1}};
  const SurfacePieces pieces = clip_to_spans(grid, mesh);
  EXPECT_GT(pieces.num_pieces(), 4000);
  expect_sound(grid, mesh, pieces);
  // A flat one: its pieces are whole spans' faces and those along its edges.
  mesh.vertices = {{0, 0, 45}, {64, 0, 45}, {0, 64, 45}};
  const SurfacePieces flat = clip_to_spans(grid, mesh);
  EXPECT_EQ(flat.num_pieces(), 64 * 65 / 2);
  for (const std::int64_t span : flat.spans) EXPECT_EQ(grid.span_index(span)[2], 45);
  expect_sound(grid, mesh, flat);
}

TEST(Clip, ClosedMeshesStayClosedToTheBit) {
  for (int seed = 0; seed < 10; ++seed) {
    const TriangleMesh mesh =
        seed % 2 ? transformed(box({0, 0, 0}, {1, 1, 1}), rotation(7.0 + 31 * seed, 3.0 + 17 * seed), {0.1, 0.2, 0.3})
                 : sphere({0.01 * seed, 0.3, -0.2}, 1, 3);
    const SplineGrid grid = grid_around(mesh, 0.07 + 0.011 * seed, 2, 0.09 * seed);
    expect_closed(clip_to_spans(grid, mesh));
  }
}

TEST(Clip, ClosedWhereVerticesAndEdgesLieInGridPlanes) {
  const SplineGrid grid = unit_grid({8, 8, 8});
  const TriangleMesh octahedron = sphere({4, 4, 4}, 3, 0);
  expect_closed(clip_to_spans(grid, octahedron));
  expect_closed(clip_to_spans(grid, box({1, 2, 3}, {4, 5, 6})));
  expect_closed(clip_to_spans(grid, box({0, 0, 0}, {8, 8, 8})));
}

TEST(Clip, PieceInAGridPlaneBelongsToTheSpanAboveItInTheLastPlaneToTheLast) {
  const SplineGrid grid = unit_grid({4, 4, 4});
  const TriangleMesh mesh = box({1, 1, 1}, {4, 2, 3});
  const SurfacePieces pieces = clip_to_spans(grid, mesh);
  expect_sound(grid, mesh, pieces);
  for (std::size_t t = 0; t < pieces.spans.size(); ++t)
    for (std::int64_t q = pieces.offsets[t]; q < pieces.offsets[t + 1]; ++q)
      for (std::size_t d = 0; d < 3; ++d) {
        const auto v = pieces.polygon(q);
        const double plane = v[0][d];
        if (std::any_of(v.begin(), v.end(), [&](const Point3& x) { return x[d] != plane; })) continue;
        EXPECT_EQ(grid.span_index(pieces.spans[t])[d], std::min<std::int64_t>(static_cast<std::int64_t>(plane), 3));
      }
}

TEST(Clip, DegenerateTrianglesMarkSpansAsTouched) {
  const SplineGrid grid = unit_grid({4, 4, 4});
  TriangleMesh mesh = random_triangles(1, 4, 3);
  mesh.vertices = {{0.5, 0.5, 0.5}, {3.5, 0.5, 0.5}, {2, 0.5, 0.5}};
  const SurfacePieces pieces = clip_to_spans(grid, mesh);
  EXPECT_EQ(pieces.spans, (std::vector<std::int64_t>{0, 1, 2, 3}));
}

TEST(Clip, RefusesVerticesOutsideTheGrid) {
  EXPECT_THROW(clip_to_spans(unit_grid({4, 4, 4}), box({1, 1, 1}, {2, 2, 4.0000001})), InputError);
}

} // namespace
} // namespace iga::prep
