// Rules of single spans, and the points of all active spans.
#include "preprocessor/fit/moment_fitting.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "format/model/span_state.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/quadrature/fitted_rules.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using namespace iga::test;

TEST(MomentFitting, AxisAlignedBoxGetsTheProductRule) {
  const TriangleMesh mesh = box({1.25, 1.5, 1.125}, {3.75, 3.25, 3.5});
  for (const std::array<int, 3>& degree : {std::array<int, 3>{2, 2, 2}, {4, 4, 4}, {1, 2, 4}, {8, 8, 8}})
    for (const Fitted& f : fit_all(grid_of(5), mesh, degree)) {
      EXPECT_EQ(f.rule.shape, SpanShape::Box);
      EXPECT_EQ(f.rule.weights.size(), static_cast<std::size_t>(product_points(degree[0]) * product_points(degree[1]) *
                                                                product_points(degree[2])));
      EXPECT_LE(f.rule.residual, 1e-14);
      expect_valid(grid_of(5), mesh, f, degree);
    }
}

TEST(MomentFitting, PrismAlongAnyAxisGetsAProduct) {
  const std::array<int, 3> degree{2, 3, 4};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    TriangleMesh mesh = prism({{1.2, 1.3}, {3.7, 1.6}, {2.1, 3.8}}, {{0, 1, 2}}, 1.25, 3.5);
    for (Point3& v : mesh.vertices) v = {v[(3 - axis + 2) % 3], v[(3 - axis) % 3], v[(3 - axis + 1) % 3]};
    const std::size_t along = (2 + axis + 1) % 3; // where the third coordinate went
    const SplineGrid grid = grid_of(5);
    for (const Fitted& f : fit_all(grid, mesh, degree)) {
      if (f.rule.shape == SpanShape::Free) ADD_FAILURE() << "axis " << along << " is not recognised";
      expect_valid(grid, mesh, f, degree);
    }
  }
}

TEST(MomentFitting, RotatedCubeOfManyDegrees) {
  const TriangleMesh mesh = transformed(box({-1, -1, -1}, {1, 1, 1}), rotation(30, 20), {2.5, 2.4, 2.6});
  const SplineGrid grid = grid_of(5);
  for (const std::array<int, 3>& degree :
       {std::array<int, 3>{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {1, 2, 4}, {4, 1, 2}, {5, 5, 5}}) {
    const auto rules = fit_all(grid, mesh, degree);
    EXPECT_GT(rules.size(), 20u);
    for (std::size_t i = 0; i < rules.size(); i += degree[0] < 3 ? 3 : 12) expect_valid(grid, mesh, rules[i], degree);
  }
}

TEST(BuildQuadrature, PointsOfAllActiveSpansHoldTheVolume) {
  const TriangleMesh mesh = sphere({0.1, 0.2, 0.3}, 1, 3);
  const SplineGrid grid = grid_around(mesh, 0.31, 2, 0.2);
  const Trimming trimming = trim(grid, mesh, {});
  QuadratureOptions options;
  const QuadratureResult result = build_quadrature(grid, trimming, options);
  ASSERT_EQ(result.points.offsets.size(), trimming.active.size() + 1);
  double volume = 0;
  for (const double w : result.points.weights) {
    EXPECT_GT(w, 0);
    volume += w;
  }
  EXPECT_NEAR(volume, volume_moments(mesh).volume, 1e-9 * volume);
  EXPECT_LE(result.max_residual, 1e-10);
  for (std::size_t a = 0; a < trimming.active.size(); ++a) {
    const Box3 span = grid.span_box(grid.span_index(trimming.active[a]));
    double sum = 0;
    for (auto g = static_cast<std::size_t>(result.points.offsets[a]);
         g < static_cast<std::size_t>(result.points.offsets[a + 1]); ++g) {
      sum += result.points.weights[g];
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_GE(result.points.parameters[3 * g + d], span.lower[d]);
        EXPECT_LE(result.points.parameters[3 * g + d], span.upper[d]);
      }
    }
    EXPECT_NEAR(sum, trimming.fraction[a] * grid.span_volume(), 1e-9 * grid.span_volume() * trimming.fraction[a]);
  }
  options.moment_degree = {0, 2, 2};
  EXPECT_THROW(build_quadrature(grid, trimming, options), InputError);
  options.moment_degree = {2, 2, 9};
  EXPECT_THROW(build_quadrature(grid, trimming, options), InputError);
}

TEST(BuildQuadrature, CanBeStopped) {
  const TriangleMesh mesh = sphere({0, 0, 0}, 1, 2);
  const SplineGrid grid = grid_around(mesh, 0.4, 2);
  QuadratureOptions options;
  options.cancelled = [] { return true; };
  EXPECT_THROW(build_quadrature(grid, trim(grid, mesh, {}), options), Cancelled);
}

TEST(FunctionMass, SharesAddUpToTheVolume) {
  for (const std::array<int, 3>& degree : {std::array<int, 3>{2, 2, 2}, {1, 2, 4}}) {
    const TriangleMesh mesh = transformed(box({-1, -1, -1}, {1, 1, 1}), rotation(30, 20), {4.5, 4.4, 4.6});
    const SplineGrid grid({0, 0, 0}, {9, 9, 9}, {27, 27, 27}, degree);
    const Trimming trimming = trim(grid, mesh, {});
    QuadratureOptions options;
    options.moment_degree = degree;
    Trimming split = trimming;
    const CellTable cells = split_into_cells(grid, {}, split);
    EXPECT_EQ(split.active, trimming.active); // no span holds several
    const std::vector<double> mass = mass_fractions(grid, split, cells, build_quadrature(grid, split, options).points);
    EXPECT_TRUE(std::is_sorted(cells.function.begin(), cells.function.end()));
    double volume = 0;
    std::int64_t whole = 0;
    for (std::size_t f = 0; f < cells.function.size(); ++f) {
      const Index3 ijk = grid.function_index(cells.function[f]);
      double full = 1;
      bool interior = true;
      for (std::size_t d = 0; d < 3; ++d) {
        double along = 0;
        for (std::int64_t e = ijk[d] - degree[d]; e <= ijk[d]; ++e) {
          std::array<double, 5> integrals{};
          ASSERT_TRUE(e >= 0 && e < 27); // the solid keeps clear of the grid's ends
          integrate_basis(grid.knots(static_cast<int>(d)), e,
                          std::span(integrals).first(static_cast<std::size_t>(degree[d] + 1)));
          along += integrals[static_cast<std::size_t>(ijk[d] - e)];
        }
        full *= along;
      }
      for (std::int64_t k = ijk[2] - degree[2]; k <= ijk[2]; ++k)
        for (std::int64_t j = ijk[1] - degree[1]; j <= ijk[1]; ++j)
          for (std::int64_t i = ijk[0] - degree[0]; i <= ijk[0]; ++i)
            interior = interior && trimming.state[static_cast<std::size_t>(grid.span_number({i, j, k}))] ==
                                       static_cast<std::uint8_t>(SpanState::Interior);
      EXPECT_GT(mass[f], 0);
      EXPECT_LE(mass[f], 1);
      if (interior) {
        EXPECT_NEAR(mass[f], 1, 1e-14);
        ++whole;
      }
      volume += mass[f] * full;
    }
    EXPECT_NEAR(volume, 8, 1e-9);
    if (degree[2] == 2) {
      EXPECT_GT(whole, 0);
    }
  }
}

} // namespace
} // namespace iga::prep
