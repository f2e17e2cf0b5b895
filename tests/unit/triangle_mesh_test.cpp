#include "format/model/triangle_mesh.hpp"

#include "tests/support/synthetic_model.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace iga {
namespace {

constexpr double pi = std::numbers::pi;

/// The torus of radii R, r about the w axis as n × n quads, shifted.
TriangleMesh torus(double R, double r, std::int32_t n, const Point3& shift) {
  TriangleMesh mesh;
  const auto number = [n](std::int32_t i, std::int32_t j) { return (i % n) * n + j % n; };
  for (std::int32_t i = 0; i < n; ++i)
    for (std::int32_t j = 0; j < n; ++j) {
      const double a = 2 * pi * i / n, b = 2 * pi * j / n, s = R + r * std::cos(b);
      mesh.vertices.push_back({shift[0] + s * std::cos(a), shift[1] + s * std::sin(a), shift[2] + r * std::sin(b)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  return mesh;
}

TEST(TriangleMesh, BoxMomentsAreExactFarFromTheOrigin) {
  test::BoxCase box;
  const Point3 shift{4096, -8192, 16384}; // powers of two: the corners stay exact
  for (std::size_t d = 0; d < 3; ++d) {
    box.A[d] += shift[d], box.B[d] += shift[d];
    box.upper[d] = box.lower[d] + 0.25 * static_cast<double>(8 + d) + shift[d];
    box.lower[d] += shift[d];
  }
  box.spans = {8, 8, 8};
  const TriangleMesh mesh = test::make_box_model(box).surface.mesh;
  const Point3 size{2, 2.25, 2.5};
  const VolumeMoments m = volume_moments(mesh);
  const double V = size[0] * size[1] * size[2];
  EXPECT_NEAR(m.volume, V, 1e-14 * V);
  EXPECT_NEAR(surface_area(mesh), 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]), 1e-13);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(m.centroid[d], box.lower[d] + size[d] / 2, 1e-11);
    EXPECT_NEAR(m.second_moments[d], V * size[d] * size[d] / 12, 1e-13 * V);
    EXPECT_NEAR(m.second_moments[3 + d], 0, 1e-13 * V);
  }
}

TEST(TriangleMesh, InsideOutIsNegative) {
  TriangleMesh mesh = test::make_box_model().surface.mesh;
  const double V = volume_moments(mesh).volume;
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(volume_moments(mesh).volume, -V, 1e-14 * V);
}

// V = 2 π² R r², I_zz = V (R² + 3/4 r²): ∫ x² = ∫ y² = I_zz / 2, ∫ z² = V r² / 4. The facets' error falls as n⁻².
TEST(TriangleMesh, TorusMomentsConvergeToTheirClosedForm) {
  const double R = 3, r = 1, V = 2 * pi * pi * R * r * r;
  const Point3 shift{10, -20, 5};
  double previous = 0;
  for (const std::int32_t n : {40, 80, 160}) {
    const VolumeMoments m = volume_moments(torus(R, r, n, shift));
    const double relative = std::abs(m.volume - V) / V;
    const double limit = 12.0 * pi * pi / (3.0 * n * n);
    EXPECT_LT(relative, limit);
    EXPECT_NEAR(m.second_moments[0] / (V * (R * R + 0.75 * r * r) / 2), 1, 2 * limit);
    EXPECT_NEAR(m.second_moments[1] / (V * (R * R + 0.75 * r * r) / 2), 1, 2 * limit);
    EXPECT_NEAR(m.second_moments[2] / (V * r * r / 4), 1, 2 * limit);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(m.centroid[d], shift[d], 5 * limit);
    if (previous > 0) {
      EXPECT_GT(std::log2(previous / relative), 1.9);
    }
    previous = relative;
  }
}

TEST(TriangleMesh, DistanceIsToTheNearestPointOfTheTriangle) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_DOUBLE_EQ(distance_to_triangle(mesh, 0, {1, 1, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_triangle(mesh, 0, {1, -2, 0}), 2);
  EXPECT_DOUBLE_EQ(distance_to_triangle(mesh, 0, {7, 0, -4}), 5);
  EXPECT_DOUBLE_EQ(distance_to_triangle(mesh, 0, {4, 3, 0}), 2.4);
}

// Unions leave needles one rounding wide: the direction of such a normal means nothing.
TEST(TriangleMesh, DistanceToANeedleIsNotFooledByItsNormal) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-17, 1e-17}};
  mesh.triangles = {{0, 1, 2}};
  for (const Point3& x : {Point3{0.25, 0, 1e-16}, Point3{0.75, -1e-16, 0}, Point3{0.5, 1e-16, 2e-16}})
    EXPECT_LE(distance_to_triangle(mesh, 0, x), 3e-16);
  EXPECT_NEAR(distance_to_triangle(mesh, 0, {0.5, 0.3, 0.4}), 0.5, 1e-15);
}

TEST(TriangleMesh, EmptyMeshHasNoVolume) {
  EXPECT_EQ(volume_moments({}).volume, 0);
}

} // namespace
} // namespace iga
