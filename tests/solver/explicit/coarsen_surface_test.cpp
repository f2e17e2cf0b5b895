// Contact surfaces whose triangles are merged: what stays lies where it was, nothing opens, deviations are told truly.
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/coarsen_surface.hpp"
#include "solver/explicit/contact/contact_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace iga::solve {
namespace {

/// The cube -1 … 1 with n × n squares on each face, each cut in two; one region per face.
TriangleMesh cube(int n) {
  TriangleMesh mesh;
  std::map<Point3, std::int32_t> known;
  const auto vertex = [&](int axis, int side, int i, int j) {
    Point3 x{};
    x[static_cast<std::size_t>(axis)] = side == 0 ? -1 : 1;
    x[static_cast<std::size_t>((axis + 1) % 3)] = -1 + 2.0 * i / n;
    x[static_cast<std::size_t>((axis + 2) % 3)] = -1 + 2.0 * j / n;
    const auto [entry, is_new] = known.try_emplace(x, static_cast<std::int32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(x);
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      mesh.region_names.push_back("face " + std::to_string(2 * axis + side));
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const std::int32_t a = vertex(axis, side, i, j), b = vertex(axis, side, i + 1, j);
          const std::int32_t c = vertex(axis, side, i + 1, j + 1), d = vertex(axis, side, i, j + 1);
          for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
            mesh.triangles.push_back(side == 1 ? t : Triangle{t[0], t[2], t[1]});
            mesh.region.push_back(2 * axis + side);
          }
        }
    }
  return mesh;
}

TriangleMesh sphere(int n) {
  TriangleMesh mesh = cube(n);
  for (Point3& x : mesh.vertices) x = times(x, 1 / norm(x));
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"sphere"};
  return mesh;
}

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::max(longest, norm(minus(mesh.vertices[static_cast<std::size_t>(t[i])],
                                             mesh.vertices[static_cast<std::size_t>(t[(i + 1) % 3])])));
  return longest;
}

void expect_closed_subset(const TriangleMesh& given, const CoarseSurface& coarse) {
  ASSERT_EQ(coarse.vertex.size(), coarse.mesh.vertices.size());
  EXPECT_TRUE(std::is_sorted(coarse.vertex.begin(), coarse.vertex.end()));
  for (std::size_t k = 0; k < coarse.vertex.size(); ++k)
    EXPECT_EQ(coarse.mesh.vertices[k], given.vertices[static_cast<std::size_t>(coarse.vertex[k])]);
  for (const auto& neighbours : make_contact_mesh(coarse.mesh, 0).neighbour)
    for (const std::int32_t n : neighbours) EXPECT_GE(n, 0);
  // Euler's formula of a sphere: no handle, no second piece.
  EXPECT_EQ(2 * coarse.mesh.vertices.size(), coarse.mesh.triangles.size() + 4);
}

double largest_distance(const TriangleMesh& given, const TriangleMesh& coarse) {
  double largest = 0;
  for (const Point3& x : given.vertices) {
    double least = 1e300;
    for (std::size_t t = 0; t < coarse.triangles.size(); ++t)
      least = std::min(least, distance_to_triangle(coarse, t, x));
    largest = std::max(largest, least);
  }
  return largest;
}

TEST(CoarsenSurface, FlatFacesKeepTheirAreasEdgesAndRegions) {
  const TriangleMesh given = cube(16);
  const CoarseSurface coarse = coarsen(given, {0.3, 0.8, 1e-9});
  expect_closed_subset(given, coarse);
  EXPECT_LT(coarse.vertex.size(), given.vertices.size() / 4);
  EXPECT_LE(longest_edge(coarse.mesh), 0.8);
  EXPECT_LT(coarse.deviation, 1e-12);
  EXPECT_NEAR(volume_moments(coarse.mesh).volume, 8, 1e-12);
  std::vector<double> area(6, 0);
  for (std::size_t f = 0; f < coarse.mesh.triangles.size(); ++f) {
    const Triangle& t = coarse.mesh.triangles[f];
    const auto x = [&](std::size_t i) { return coarse.mesh.vertices[static_cast<std::size_t>(t[i])]; };
    area[static_cast<std::size_t>(coarse.mesh.region[f])] += 0.5 * norm(twice_area(x(0), x(1), x(2)));
  }
  for (const double a : area) EXPECT_NEAR(a, 4, 1e-12);
}

TEST(CoarsenSurface, SaysHowFarACurvedSurfaceIsLeft) {
  const TriangleMesh given = sphere(16);
  for (const double allowed : {0.002, 0.01, 0.05}) {
    const CoarseSurface coarse = coarsen(given, {0.35, 0.7, allowed});
    expect_closed_subset(given, coarse);
    EXPECT_LT(coarse.vertex.size(), given.vertices.size());
    EXPECT_LE(coarse.deviation, allowed);
    // What it says bounds the distance to the whole surface, and is no idle number.
    const double true_distance = largest_distance(given, coarse.mesh);
    EXPECT_LE(true_distance, coarse.deviation + 1e-12);
    EXPECT_GT(true_distance, 0.3 * coarse.deviation);
    // Areas behind contact: those of the inscribed surface.
    EXPECT_LT(surface_area(coarse.mesh), 4 * std::numbers::pi);
    EXPECT_GT(surface_area(coarse.mesh), 4 * std::numbers::pi * (1 - 4 * allowed - 0.01));
  }
}

TEST(CoarsenSurface, LeavesAloneWhatIsCoarseEnough) {
  const TriangleMesh given = sphere(6);
  for (const CoarsenSettings& settings :
       {CoarsenSettings{0, 1, 1}, CoarsenSettings{0.05, 1, 1}, CoarsenSettings{0.5, 1, 0}}) {
    const CoarseSurface coarse = coarsen(given, settings);
    EXPECT_EQ(coarse.mesh.vertices, given.vertices);
    EXPECT_EQ(coarse.mesh.triangles, given.triangles);
    EXPECT_EQ(coarse.deviation, 0);
  }
}

} // namespace
} // namespace iga::solve
