// Quadrature of real parts, with CGAL as the judge of what lies inside and of single spans' moments.
#include "format/model/span_state.hpp"
#include "preprocessor/fit/span_moments.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "tests/embed/surfaces.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/clip.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace iga::prep {
namespace {

using namespace iga::test;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

struct Case {
  const char* part;
  int degree, spans, moment_degree;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.part << " p" << c.degree << " n" << c.spans << " q" << c.moment_degree;
}

TriangleMesh load(const std::string& name) {
  const auto file = shared_part("valid/" + name);
  return file.empty() ? TriangleMesh{} : read_stl(file, weld_of(name));
}

Mesh cgal_mesh(const std::vector<Point3>& vertices, const std::vector<Triangle>& triangles) {
  std::vector<Kernel::Point_3> points;
  for (const Point3& v : vertices) points.emplace_back(v[0], v[1], v[2]);
  std::vector<std::array<std::size_t, 3>> faces;
  for (const Triangle& t : triangles)
    faces.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  Mesh mesh;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, faces, mesh);
  return mesh;
}

QuadratureResult fit(const SplineGrid& grid, const Trimming& trimming, int moment_degree,
                     const std::string& rule = "nnls") {
  QuadratureOptions options;
  options.trimmed_rule = rule;
  options.moment_degree = {moment_degree, moment_degree, moment_degree};
  return build_quadrature(grid, trimming, options);
}

bool is_trimmed(const Trimming& trimming, std::size_t active) {
  return trimming.state[static_cast<std::size_t>(trimming.active[active])] ==
         static_cast<std::uint8_t>(SpanState::Trimmed);
}

/// What every rule fulfils: small residuals, positive weights that sum to the volume, points inside after CGAL.
void expect_positive_and_inside(const TriangleMesh& mesh, const SplineGrid& grid, const Trimming& trimming,
                                const QuadratureResult& result) {
  EXPECT_LE(result.max_residual, 1e-10);
  const IntegrationPoints& points = result.points;
  double volume = 0;
  for (const double w : points.weights) {
    ASSERT_GT(w, 0);
    volume += w;
  }
  EXPECT_NEAR(volume, trimming.exact_volume + trimming.snapped_volume, 1e-9 * trimming.exact_volume);

  const Mesh surface = cgal_mesh(mesh.vertices, mesh.triangles);
  Tree tree(CGAL::faces(surface).first, CGAL::faces(surface).second, surface);
  tree.build();
  tree.accelerate_distance_queries();
  const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side(tree);
  std::atomic<int> outside{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, trimming.active.size(), 16), [&](const auto& range) {
    for (std::size_t a = range.begin(); a != range.end(); ++a) {
      if (!is_trimmed(trimming, a)) continue;
      for (auto g = static_cast<std::size_t>(points.offsets[a]); g < static_cast<std::size_t>(points.offsets[a + 1]);
           ++g) {
        const Point3 x =
            grid.to_position({points.parameters[3 * g], points.parameters[3 * g + 1], points.parameters[3 * g + 2]});
        const Kernel::Point_3 p(x[0], x[1], x[2]);
        if (side(p) == CGAL::ON_UNBOUNDED_SIDE && std::sqrt(tree.squared_distance(p)) > 1e-9 * diagonal(mesh))
          ++outside;
      }
    }
  });
  EXPECT_EQ(outside, 0);
}

class SharedPart : public testing::TestWithParam<Case> {};

TEST_P(SharedPart, EverySpanIsFittedWithPointsInside) {
  const Case& c = GetParam();
  const TriangleMesh mesh = load(c.part);
  if (mesh.triangles.empty()) GTEST_SKIP() << "the shared STL parts are absent";
  const SplineGrid grid = grid_with(mesh, c.spans, c.degree);
  const Trimming trimming = trim(grid, mesh, {});
  const QuadratureResult result = fit(grid, trimming, c.moment_degree);
  expect_positive_and_inside(mesh, grid, trimming, result);
  const auto num_moments = static_cast<std::int64_t>(std::pow(c.moment_degree + 1, 3));
  for (std::size_t a = 0; a < trimming.active.size(); ++a)
    if (is_trimmed(trimming, a)) {
      EXPECT_LE(result.points.offsets[a + 1] - result.points.offsets[a], num_moments);
    }
}

class MinimalRuleOfSharedPart : public testing::TestWithParam<Case> {};

TEST_P(MinimalRuleOfSharedPart, HasFewPointsAllInside) {
  const Case& c = GetParam();
  const TriangleMesh mesh = load(c.part);
  if (mesh.triangles.empty()) GTEST_SKIP() << "the shared STL parts are absent";
  const SplineGrid grid = grid_with(mesh, c.spans, c.degree);
  const Trimming trimming = trim(grid, mesh, {});
  const QuadratureResult result = fit(grid, trimming, c.moment_degree, "minimal");
  expect_positive_and_inside(mesh, grid, trimming, result);
  std::int64_t spans = 0, points = 0;
  for (std::size_t a = 0; a < trimming.active.size(); ++a)
    if (is_trimmed(trimming, a)) {
      ++spans;
      points += result.points.offsets[a + 1] - result.points.offsets[a];
    }
  if (spans == 0) return;
  const double average = static_cast<double>(points) / static_cast<double>(spans);
  const double moments = std::pow(c.degree + 1, 3);
  // Spans with more points for rigidity, in parts a span or two thick, have up to as many as there are moments.
  const double secured = static_cast<double>(result.counts.stabilised_spans) / static_cast<double>(spans);
  const double most = (1 - secured) * (c.degree == 2 ? 13 : 31) + secured * moments;
  // In a sheet far thinner than a span points have two directions to move in, and short ways to go.
  const bool sheet = 2 * trimming.exact_volume / surface_area(mesh) < 0.01 * grid.span_size()[0];
  EXPECT_LT(average, sheet ? moments : most)
      << spans << " trimmed spans, " << result.counts.stabilised_spans << " secured";
}

std::vector<Case> all_parts(int degree, int spans) {
  std::vector<Case> cases;
  for (const char* part : {"1002_tray_bottom.STL",
                           "20mm-xyz-cube.stl",
                           "7_8ths_cube.stl",
                           "ADIS16480.STL",
                           "A_Drive_Frame_Upper_x1.stl",
                           "Rear_Bed_Mount_Right_x1.stl",
                           "Spool_Holder_x1.STL",
                           "X_Carriage_x1.stl",
                           "angle_block.STL",
                           "busted.STL",
                           "cube_rot.stl",
                           "cube_theta0_aligned.stl",
                           "cube_theta3.stl",
                           "cyl_r40_h100.stl",
                           "cylinder.stl",
                           "elephant.stl",
                           "featuretype.STL",
                           "idler_riser.STL",
                           "large_block_obb.STL",
                           "octagonal_pocket.stl",
                           "plate_holes.STL",
                           "plate_rot_t0.005.stl",
                           "round.stl",
                           "torus.STL",
                           "two_objects_mixed_case_names.stl",
                           "unit_cube.STL",
                           "unit_sphere.STL"})
    cases.push_back({part, degree, spans, degree});
  return cases;
}

// All valid parts at degree 2; some at degrees 3 and 4 and with moments of twice the degree.
INSTANTIATE_TEST_SUITE_P(Degree2, SharedPart, testing::ValuesIn(all_parts(2, 20)));
INSTANTIATE_TEST_SUITE_P(HigherDegrees, SharedPart,
                         testing::Values(Case{"busted.STL", 3, 20, 3}, Case{"torus.STL", 3, 20, 3},
                                         Case{"plate_rot_t0.005.stl", 3, 20, 3}, Case{"plate_rot_t0.005.stl", 4, 20, 4},
                                         Case{"cube_rot.stl", 4, 20, 4}, Case{"elephant.stl", 4, 10, 4},
                                         Case{"cube_rot.stl", 2, 20, 4}, Case{"elephant.stl", 2, 10, 4},
                                         Case{"cube_rot.stl", 3, 6, 6}));
INSTANTIATE_TEST_SUITE_P(Degree2, MinimalRuleOfSharedPart, testing::ValuesIn(all_parts(2, 20)));
INSTANTIATE_TEST_SUITE_P(Degree3, MinimalRuleOfSharedPart, testing::ValuesIn(all_parts(3, 8)));

// Spans with 1, ξ, η, ζ, ξη, ηζ, ζξ of the part that CGAL cuts out of the whole mesh.
TEST(SharedParts, MomentsAgreeWithClipsByCgal) {
  namespace PMP = CGAL::Polygon_mesh_processing;
  int compared = 0;
  for (const char* part : {"busted.STL", "elephant.stl", "cylinder.stl"}) {
    SCOPED_TRACE(part);
    const TriangleMesh mesh = load(part);
    if (mesh.triangles.empty()) GTEST_SKIP() << "the shared STL parts are absent";
    const SplineGrid grid = grid_around(mesh, diagonal(mesh) / 17.3, 2, 0.37);
    const Trimming trimming = trim(grid, mesh, {});
    const FarMoments far(grid, trimming, {1, 1, 1});
    const Mesh whole = cgal_mesh(to_span_units(grid, mesh), mesh.triangles);
    LocalSurface local;
    for (std::size_t t = 0; t < trimming.pieces.spans.size(); t += trimming.pieces.spans.size() / 12) {
      if (trimming.touched_fraction[t] < 1e-6) continue;
      gather_local_surface(grid, trimming, t, local);
      std::array<double, 8> m;
      span_moments(local, far.find(t), {1, 1, 1}, m.data());
      const TriangleMesh cube = box(
          {static_cast<double>(local.span[0]), static_cast<double>(local.span[1]), static_cast<double>(local.span[2])},
          {static_cast<double>(local.span[0] + 1), static_cast<double>(local.span[1] + 1),
           static_cast<double>(local.span[2] + 1)});
      Mesh clipped = whole, clipper = cgal_mesh(cube.vertices, cube.triangles);
      if (!PMP::clip(clipped, clipper, CGAL::parameters::clip_volume(true))) continue;
      PMP::triangulate_faces(clipped);
      // Tetrahedra about the span's corner: volume, mean and mean of products are exact for polynomials of degree 2.
      std::array<double, 8> exact{};
      for (const auto face : clipped.faces()) {
        std::array<Point3, 4> x{};
        auto h = clipped.halfedge(face);
        for (std::size_t a = 1; a < 4; ++a, h = clipped.next(h))
          for (std::size_t d = 0; d < 3; ++d) {
            const double v = clipped.point(clipped.target(h))[static_cast<int>(d)] - static_cast<double>(local.span[d]);
            x[a][d] = (v - local.box.lower[d]) / (local.box.upper[d] - local.box.lower[d]);
          }
        const double det = x[1][0] * (x[2][1] * x[3][2] - x[2][2] * x[3][1]) -
                           x[1][1] * (x[2][0] * x[3][2] - x[2][2] * x[3][0]) +
                           x[1][2] * (x[2][0] * x[3][1] - x[2][1] * x[3][0]);
        // A rule of degree 3: the middle with -4/5, four points with 9/20 each.
        for (int g = 0; g < 5; ++g) {
          Point3 y{};
          for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t d = 0; d < 3; ++d)
              y[d] += (g == 4 ? 0.25 : static_cast<int>(a) == g ? 0.5 : 1.0 / 6) * x[a][d];
          const double w = det / 6 * (g == 4 ? -0.8 : 0.45);
          for (std::size_t k = 0; k < 8; ++k)
            exact[k] += w * (k & 1 ? 2 * y[0] - 1 : 1) * (k & 2 ? 2 * y[1] - 1 : 1) * (k & 4 ? 2 * y[2] - 1 : 1);
        }
      }
      for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(m[k], exact[k], 1e-11) << "touched " << t << " moment " << k;
      ++compared;
    }
  }
  EXPECT_GT(compared, 24);
}

struct Outcome {
  Trimming trimming;
  QuadratureResult result;
  SplineGrid grid;
};

Outcome run(const TriangleMesh& mesh) {
  Outcome out;
  out.grid = grid_with(mesh, 12, 2);
  out.trimming = trim(out.grid, mesh, {});
  out.result = fit(out.grid, out.trimming, 2);
  return out;
}

// A factor of two changes no bit. Other factors and shifts round the vertices (a shift by 1e4 sizes at 1e-12 of the
// size), and NNLS then chooses otherwise between nearly equal candidates in single spans: states, fractions and numbers
// of points stay, positions only where the choice does.
TEST(SharedParts, ScaleAndPlaceDoNotMatter) {
  for (const char* part : {"busted.STL", "torus.STL"}) {
    SCOPED_TRACE(part);
    const TriangleMesh mesh = load(part);
    if (mesh.triangles.empty()) GTEST_SKIP() << "the shared STL parts are absent";
    const Outcome original = run(mesh);
    const double size = diagonal(mesh);
    const auto compare = [&](double scale, const Point3& shift, double tolerance) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " shift " << shift[0]);
      TriangleMesh other = mesh;
      for (Point3& v : other.vertices)
        for (std::size_t d = 0; d < 3; ++d) v[d] = scale * v[d] + shift[d];
      const Outcome changed = run(other);
      EXPECT_EQ(changed.trimming.state, original.trimming.state);
      const auto &p = original.result.points, &q = changed.result.points;
      ASSERT_EQ(p.offsets, q.offsets);
      EXPECT_LE(changed.result.max_residual, 1e-10);
      EXPECT_NEAR(changed.trimming.exact_volume, std::pow(scale, 3) * original.trimming.exact_volume,
                  1e-10 * changed.trimming.exact_volume);
      std::size_t moved = 0;
      for (std::size_t a = 0; a + 1 < p.offsets.size(); ++a) {
        double worst = 0;
        for (auto g = 3 * static_cast<std::size_t>(p.offsets[a]); g < 3 * static_cast<std::size_t>(p.offsets[a + 1]);
             ++g)
          worst = std::max(worst, std::abs((q.parameters[g] - changed.grid.A()[g % 3]) / scale -
                                           (p.parameters[g] - original.grid.A()[g % 3])));
        moved += worst > tolerance * size;
      }
      EXPECT_EQ(moved, 0u) << "spans with other points, of " << p.offsets.size() - 1;
    };
    for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) compare(scale, {0, 0, 0}, 1e-9);
    compare(1024, {0, 0, 0}, 1e-15);
    compare(1, {1e4 * size, -1e4 * size, 1e4 * size}, 1e-7);
  }
}

TEST(SharedParts, OneAndTwoThreadsGiveTheSameBytes) {
  for (const char* part : {"busted.STL", "plate_rot_t0.005.stl"}) {
    SCOPED_TRACE(part);
    const TriangleMesh mesh = load(part);
    if (mesh.triangles.empty()) GTEST_SKIP() << "the shared STL parts are absent";
    std::array<Outcome, 2> out;
    std::array<CellTable, 2> cells;
    std::array<std::vector<double>, 2> mass;
    for (std::size_t threads : {1, 2}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      out[threads - 1] = run(mesh);
      Outcome& o = out[threads - 1];
      cells[threads - 1] = split_into_cells(o.grid, {}, o.trimming);
      o.result = fit(o.grid, o.trimming, 2);
      mass[threads - 1] = mass_fractions(o.grid, o.trimming, cells[threads - 1], o.result.points);
    }
    const Trimming &s = out[0].trimming, &t = out[1].trimming;
    EXPECT_EQ(s.state, t.state);
    EXPECT_EQ(s.fraction, t.fraction);
    EXPECT_EQ(s.pieces.vertices, t.pieces.vertices);
    EXPECT_EQ(s.exact_volume, t.exact_volume);
    EXPECT_EQ(out[0].result.points.parameters, out[1].result.points.parameters);
    EXPECT_EQ(out[0].result.points.weights, out[1].result.points.weights);
    EXPECT_EQ(out[0].result.points.residual, out[1].result.points.residual);
    EXPECT_EQ(cells[0].function, cells[1].function);
    EXPECT_EQ(cells[0].functions, cells[1].functions);
    EXPECT_EQ(mass[0], mass[1]);
  }
}

} // namespace
} // namespace iga::prep
