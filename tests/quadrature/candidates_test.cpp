// Candidates lie inside the solid, whatever the lattice lines meet.
#include "preprocessor/fit/candidates.hpp"

#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/convex_solid.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

// All candidates of a dense lattice in all touched spans against the half-spaces of a convex solid.
std::size_t expect_inside(const SplineGrid& grid, const TriangleMesh& mesh) {
  const Trimming trimming = trim(grid, mesh, {});
  const auto planes = half_spaces(to_span_units(grid, mesh), mesh.triangles);
  LocalSurface local;
  PieceInterior interior;
  LineCaster caster;
  std::size_t checked = 0;
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); ++t) {
    if (trimming.touched_fraction[t] <= 1e-14) continue;
    gather_local_surface(grid, trimming, t, local);
    interior.attach(local);
    caster.attach(local, interior);
    for (const int n : {5, 8}) {
      std::vector<double> points;
      const auto& lattice = gauss_legendre(n).nodes;
      for (std::size_t axis = 0; axis < 3; ++axis) caster.append_candidates(axis, lattice, lattice, 3, 2, points);
      for (std::size_t g = 0; g + 2 < points.size(); g += 3) {
        long double worst = -1;
        Long3 x;
        for (std::size_t d = 0; d < 3; ++d)
          x[d] = static_cast<long double>(local.span[d]) + local.box.lower[d] +
                 static_cast<long double>(points[g + d]) * (local.box.upper[d] - local.box.lower[d]);
        for (const HalfSpace& h : planes)
          worst = std::max(worst, h.n[0] * x[0] + h.n[1] * x[1] + h.n[2] * x[2] - h.offset);
        EXPECT_LT(worst, 1e-13L) << "span " << local.span[0] << " " << local.span[1] << " " << local.span[2];
        ++checked;
      }
    }
  }
  return checked;
}

// The box around a triangular corner has the corner's long edge as its diagonal, and lattice lines lie on it: there
// they graze the fold between two sheets.
TEST(Candidates, LinesThatGrazeAFoldAddNothingOutside) {
  const SplineGrid grid({0, 0, 0}, {4, 4, 4}, {4, 4, 4}, {2, 2, 2});
  const double s = 0.4, t = 1e-3;
  // Triangular plate with corners (s, 0), (0, s), oblique in z, cut at the planes of the grid.
  for (const double slope : {0.0, 0.3, 1.0}) {
    TriangleMesh mesh = prism({{1.5, 1.5}, {2 + s, 1.5}, {1.5, 2 + s}}, {{0, 1, 2}}, 0, t);
    for (Point3& v : mesh.vertices) v[2] += 1.3 + slope * (v[0] - 1.5) + 0.7 * slope * (v[1] - 1.5);
    EXPECT_GT(expect_inside(grid, mesh), 100u);
  }
  // Both sheets leave the fold to the same side.
  TriangleMesh folded = prism({{1.5, 1.5}, {2 + s, 1.5}, {1.5, 2 + s}}, {{0, 1, 2}}, 0, t);
  for (Point3& v : folded.vertices) {
    const double z = v[2];
    v[2] = 1.5 + v[0] - v[1] + z;
    v[0] -= z;
    v[1] += z;
  }
  EXPECT_GT(expect_inside(grid, folded), 100u);
}

TEST(Candidates, InsideOfRotatedCubesPlatesAndWedges) {
  for (int k = 0; k < 8; ++k) {
    const Rotation R = rotation(15.0 * k, 45.0 * (k % 3) + 7 * (k / 3));
    const TriangleMesh cube = transformed(box({0, 0, 0}, {1, 1, 1}), R, {});
    expect_inside(grid_around(cube, 0.3, 2, 0.13 * k), cube);
    const TriangleMesh plate = transformed(box({0, 0, 0}, {1, 1, 2e-4}), R, {});
    expect_inside(grid_around(plate, 0.3, 2, 0.13 * k), plate);
    const TriangleMesh wedge = transformed(prism({{0, 0}, {1, 0}, {1, 0.01}}, {{0, 1, 2}}, 0, 1), R, {});
    expect_inside(grid_around(wedge, 0.3, 2, 0.13 * k), wedge);
  }
}

} // namespace
} // namespace iga::prep
