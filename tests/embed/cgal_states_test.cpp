// CGAL as an independent judge of the trimming on real parts: states against its inside/outside test at all span
// centres and corners, volume, centroid and second moments against the mesh's own.
#include "format/model/span_state.hpp"
#include "preprocessor/fit/span_moments.hpp"
#include "preprocessor/trim/trim.hpp"
#include "tests/embed/surfaces.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace iga::prep {
namespace {

using namespace iga::test;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

class CgalJudge {
 public:
  explicit CgalJudge(const TriangleMesh& mesh) {
    std::vector<Kernel::Point_3> points;
    for (const Point3& v : mesh.vertices) points.emplace_back(v[0], v[1], v[2]);
    std::vector<std::array<std::size_t, 3>> faces;
    for (const Triangle& t : mesh.triangles)
      faces.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
    CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(points, faces, mesh_);
    tree_.insert(CGAL::faces(mesh_).first, CGAL::faces(mesh_).second, mesh_);
    tree_.build();
    tree_.accelerate_distance_queries();
    side_ = std::make_unique<CGAL::Side_of_triangle_mesh<Mesh, Kernel>>(tree_);
  }

  /// +1 inside, 0 on the surface, -1 outside.
  int side(const Point3& x) const {
    const auto s = (*side_)(Kernel::Point_3(x[0], x[1], x[2]));
    return s == CGAL::ON_BOUNDED_SIDE ? 1 : s == CGAL::ON_BOUNDARY ? 0 : -1;
  }
  double distance(const Point3& x) const {
    return std::sqrt(tree_.squared_distance(Kernel::Point_3(x[0], x[1], x[2])));
  }
  bool closed() const { return CGAL::is_closed(mesh_); }

 private:
  Mesh mesh_;
  Tree tree_;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<Mesh, Kernel>> side_;
};

/// Sides of all points of a lattice with n points per direction, u fastest.
template <class Position>
std::vector<std::int8_t> sides(const CgalJudge& judge, const Index3& n, const Position& position) {
  std::vector<std::int8_t> side(static_cast<std::size_t>(n[0] * n[1] * n[2]));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, side.size(), 256), [&](const auto& range) {
    for (std::size_t q = range.begin(); q != range.end(); ++q) {
      const auto m = static_cast<std::int64_t>(q);
      side[q] = static_cast<std::int8_t>(judge.side(position({m % n[0], m / n[0] % n[1], m / (n[0] * n[1])})));
    }
  });
  return side;
}

class StateComparison {
 public:
  StateComparison(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming, const CgalJudge& judge)
      : grid_(grid), trimming_(trimming), judge_(judge), size_(diagonal(mesh)) {}

  /// Points at which a state and CGAL differ further from the surface than rounding (in a snapped span: than the
  /// depth).
  std::int64_t count_differences() {
    const Index3 n = grid_.spans(), c{n[0] + 1, n[1] + 1, n[2] + 1};
    const auto corner = [&](const Index3& i) { return at(i, 0); };
    const auto centre = [&](const Index3& i) { return at(i, 0.5); };
    const auto corner_sides = sides(judge_, c, corner);
    const auto centre_sides = sides(judge_, n, centre);
    std::int64_t wrong = 0;
    for (std::int64_t s = 0; s < grid_.num_spans(); ++s) {
      const int state = trimming_.state[static_cast<std::size_t>(s)];
      if (state == static_cast<int>(SpanState::Trimmed)) continue;
      const int expected = state == static_cast<int>(SpanState::Interior) ? 1 : -1;
      const Index3 i = grid_.span_index(s);
      if (centre_sides[static_cast<std::size_t>(s)] == -expected) wrong += far_from_surface(s, centre(i));
      for (std::int64_t q = 0; q < 8; ++q) {
        const Index3 v{i[0] + q % 2, i[1] + q / 2 % 2, i[2] + q / 4};
        if (corner_sides[static_cast<std::size_t>(v[0] + c[0] * (v[1] + c[1] * v[2]))] == -expected)
          wrong += far_from_surface(s, corner(v));
      }
    }
    return wrong;
  }

 private:
  Point3 at(const Index3& i, double offset) const {
    Point3 u;
    for (std::size_t d = 0; d < 3; ++d)
      u[d] = grid_.A()[d] + grid_.span_size()[d] * (static_cast<double>(i[d]) + offset);
    return grid_.to_position(u);
  }
  bool far_from_surface(std::int64_t span, const Point3& x) const {
    const auto& touched = trimming_.pieces.spans;
    const bool snapped = std::binary_search(touched.begin(), touched.end(), span);
    const double depth = snapped ? 2e-5 * std::sqrt(3.0) * grid_.span_size()[0] : 0;
    return judge_.distance(x) > std::max(1e-9 * size_, depth);
  }

  const SplineGrid& grid_;
  const Trimming& trimming_;
  const CgalJudge& judge_;
  double size_;
};

/// ∫ 1, ξ, ξ², ξη … of the solid in span units relative to an origin; second moments xx yy zz xy yz zx.
struct SolidMoments {
  double volume = 0;
  Point3 first{};
  std::array<double, 6> second{};
};

constexpr std::array<std::array<std::size_t, 2>, 6> pairs{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};

// Adds a box with lower corner `low` and sides `size` whose Legendre moments up to degree 2 are m (a fastest).
void add_box(SolidMoments& sum, const Point3& low, const Point3& size, const std::array<double, 27>& m) {
  const double box = size[0] * size[1] * size[2];
  const auto legendre = [&](const Index3& d) { return m[static_cast<std::size_t>(d[0] + 3 * (d[1] + 3 * d[2]))]; };
  const auto unit = [](std::size_t a) {
    Index3 d{};
    d[a] = 1;
    return d;
  };
  const double m0 = m[0];
  Point3 m1; // x = (P1 + 1) / 2
  for (std::size_t a = 0; a < 3; ++a) m1[a] = (legendre(unit(a)) + m0) / 2;
  sum.volume += box * m0;
  for (std::size_t a = 0; a < 3; ++a) sum.first[a] += box * (low[a] * m0 + size[a] * m1[a]);
  for (std::size_t q = 0; q < 6; ++q) {
    const auto [a, b] = pairs[q];
    Index3 d{};
    ++d[a];
    ++d[b];
    // x² = (P2 + 3 P1 + 2) / 6 and xy = (P1 P1 + P1 + P1 + 1) / 4
    const double m2 = a == b ? (legendre(d) + 3 * legendre(unit(a)) + 2 * m0) / 6
                             : (legendre(d) + legendre(unit(a)) + legendre(unit(b)) + m0) / 4;
    sum.second[q] +=
        box * (low[a] * low[b] * m0 + low[a] * size[b] * m1[b] + low[b] * size[a] * m1[a] + size[a] * size[b] * m2);
  }
}

// From the trimming alone.
SolidMoments solid_moments(const SplineGrid& grid, const Trimming& trimming, const Point3& origin) {
  SolidMoments sum;
  std::array<double, 27> full{};
  full[0] = 1;
  const FarMoments far(grid, trimming, {2, 2, 2});
  const auto low_of = [&](const Index3& i) {
    return Point3{static_cast<double>(i[0]) - origin[0], static_cast<double>(i[1]) - origin[1],
                  static_cast<double>(i[2]) - origin[2]};
  };
  LocalSurface local;
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); ++t) {
    const double fraction = trimming.touched_fraction[t];
    if (fraction <= 0) continue;
    const Index3 i = grid.span_index(trimming.pieces.spans[t]);
    Point3 low = low_of(i);
    if (fraction >= 1) {
      add_box(sum, low, {1, 1, 1}, full);
      continue;
    }
    gather_local_surface(grid, trimming, t, local);
    std::array<double, 27> m;
    span_moments(local, far.find(t), {2, 2, 2}, m.data());
    Point3 size;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] += local.box.lower[d];
      size[d] = local.box.upper[d] - local.box.lower[d];
    }
    add_box(sum, low, size, m);
  }
  for (const std::int64_t span : trimming.active)
    if (!std::binary_search(trimming.pieces.spans.begin(), trimming.pieces.spans.end(), span))
      add_box(sum, low_of(grid.span_index(span)), {1, 1, 1}, full);
  return sum;
}

void expect_moments(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming) {
  const VolumeMoments exact = volume_moments(mesh);
  const Point3 h = grid.span_size();
  Point3 origin;
  for (std::size_t d = 0; d < 3; ++d) origin[d] = (grid.to_parameter(exact.centroid)[d] - grid.A()[d]) / h[d];
  const SolidMoments m = solid_moments(grid, trimming, origin);
  const double size = diagonal(mesh), scale = grid.span_volume();
  EXPECT_NEAR(trimming.exact_volume, exact.volume, 1e-12 * exact.volume);
  EXPECT_NEAR(m.volume * scale, exact.volume, 1e-12 * exact.volume);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(m.first[d] * h[d] * scale / exact.volume, 0, 1e-12 * size);
  const double inertia = exact.second_moments[0] + exact.second_moments[1] + exact.second_moments[2];
  for (std::size_t q = 0; q < 6; ++q)
    EXPECT_NEAR(m.second[q] * h[pairs[q][0]] * h[pairs[q][1]] * scale, exact.second_moments[q], 1e-12 * inertia) << q;
}

TEST(StateComparison, SeesOneWrongState) {
  const TriangleMesh mesh = transformed(box({0, 0, 0}, {1, 1, 1}), rotation(30, 20), {});
  const CgalJudge judge(mesh);
  const SplineGrid grid = grid_with(mesh, 10, 2);
  Trimming trimming = trim(grid, mesh, {});
  EXPECT_EQ(StateComparison(grid, mesh, trimming, judge).count_differences(), 0);
  const Index3 n = grid.spans();
  trimming.state[static_cast<std::size_t>(grid.span_number({n[0] / 2, n[1] / 2, n[2] / 2}))] =
      static_cast<std::uint8_t>(SpanState::Exterior);
  EXPECT_EQ(StateComparison(grid, mesh, trimming, judge).count_differences(), 9);
}

class ValidPart : public testing::TestWithParam<const char*> {};

TEST_P(ValidPart, AgreesWithCgalAndKeepsItsMoments) {
  const auto file = shared_part(std::string("valid/") + GetParam());
  if (file.empty()) GTEST_SKIP() << "the shared STL parts are absent";
  const TriangleMesh mesh = read_stl(file, weld_of(GetParam()));
  const CgalJudge judge(mesh);
  ASSERT_TRUE(judge.closed());
  for (const int count : {10, 20, 40}) {
    SCOPED_TRACE(count);
    const SplineGrid grid = grid_with(mesh, count, 2);
    const Trimming trimming = trim(grid, mesh, {});
    EXPECT_LT(trimming.worst_leak, 1e-12);
    EXPECT_EQ(StateComparison(grid, mesh, trimming, judge).count_differences(), 0);
    expect_moments(grid, mesh, trimming);
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, ValidPart,
                         testing::Values("1002_tray_bottom.STL", "20mm-xyz-cube.stl", "7_8ths_cube.stl",
                                         "ADIS16480.STL", "A_Drive_Frame_Upper_x1.stl", "Rear_Bed_Mount_Right_x1.stl",
                                         "Spool_Holder_x1.STL", "X_Carriage_x1.stl", "angle_block.STL", "busted.STL",
                                         "cube_rot.stl", "cube_theta0_aligned.stl", "cube_theta3.stl",
                                         "cyl_r40_h100.stl", "cylinder.stl", "elephant.stl", "featuretype.STL",
                                         "idler_riser.STL", "large_block_obb.STL", "octagonal_pocket.stl",
                                         "plate_holes.STL", "plate_rot_t0.005.stl", "round.stl", "torus.STL",
                                         "two_objects_mixed_case_names.stl", "unit_cube.STL", "unit_sphere.STL"));

} // namespace
} // namespace iga::prep
