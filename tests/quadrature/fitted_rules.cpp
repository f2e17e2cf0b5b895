#include "tests/quadrature/fitted_rules.hpp"

#include "format/model/span_state.hpp"
#include "tests/quadrature/convex_solid.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::test {

using namespace prep;

SplineGrid grid_of(std::int64_t n, int degree) {
  const auto size = static_cast<double>(n);
  return SplineGrid({0, 0, 0}, {size, size, size}, {n, n, n}, {degree, degree, degree});
}

std::vector<Fitted> fit_all(const SplineGrid& grid, const TriangleMesh& mesh, const std::array<int, 3>& degree,
                            const Reduce& reduce) {
  const Trimming trimming = trim(grid, mesh, {});
  const FarMoments far(grid, trimming, degree);
  MomentFitter fitter(grid, trimming, far, degree, 1e-10);
  std::vector<Fitted> rules;
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); ++t)
    if (trimming.state[static_cast<std::size_t>(trimming.pieces.spans[t])] ==
        static_cast<std::uint8_t>(SpanState::Trimmed)) {
      rules.push_back({grid.span_index(trimming.pieces.spans[t]), t, fitter.fit(t)});
      if (reduce) reduce(rules.back(), trimming, far);
    }
  return rules;
}

void expect_valid(const SplineGrid& grid, const TriangleMesh& mesh, const Fitted& f, const std::array<int, 3>& degree) {
  const auto planes = half_spaces(to_span_units(grid, mesh), mesh.triangles);
  const auto num_moments = static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1));
  const auto box_points =
      static_cast<std::size_t>(product_points(degree[0]) * product_points(degree[1]) * product_points(degree[2]));
  EXPECT_LE(f.rule.weights.size(), std::max(num_moments, box_points));
  ASSERT_FALSE(f.rule.weights.empty());
  EXPECT_LE(f.rule.residual, 1e-10);
  Polyhedron solid = cube_of(f.span);
  for (const HalfSpace& plane : planes) solid = cut(solid, plane);
  Box3 box{{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}};
  for (const auto& face : solid)
    for (const Long3& x : face)
      for (std::size_t d = 0; d < 3; ++d) {
        box.lower[d] = std::min(box.lower[d], static_cast<double>(x[d]));
        box.upper[d] = std::max(box.upper[d], static_cast<double>(x[d]));
      }
  const auto exact = legendre_moments(solid, box, degree);
  std::vector<long double> sum(exact.size(), 0);
  Long3 size;
  for (std::size_t d = 0; d < 3; ++d) size[d] = static_cast<long double>(box.upper[d]) - box.lower[d];
  for (std::size_t g = 0; g < f.rule.weights.size(); ++g) {
    EXPECT_GT(f.rule.weights[g], 0);
    Long3 x;
    double P[3][max_moment_degree + 1];
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_GE(f.rule.points[3 * g + d], 0);
      EXPECT_LE(f.rule.points[3 * g + d], 1);
      x[d] = static_cast<long double>(f.span[d]) + f.rule.points[3 * g + d];
      legendre(static_cast<double>((x[d] - box.lower[d]) / size[d]), degree[d], P[d]);
    }
    for (const HalfSpace& h : planes) EXPECT_LT(h.n[0] * x[0] + h.n[1] * x[1] + h.n[2] * x[2] - h.offset, 1e-13L);
    std::size_t m = 0;
    for (int c = 0; c <= degree[2]; ++c)
      for (int b = 0; b <= degree[1]; ++b)
        for (int a = 0; a <= degree[0]; ++a)
          sum[m++] += f.rule.weights[g] / (size[0] * size[1] * size[2]) * P[0][a] * P[1][b] * P[2][c];
  }
  long double difference = 0, norm = 0;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    difference += (sum[k] - exact[k]) * (sum[k] - exact[k]);
    norm += exact[k] * exact[k];
  }
  EXPECT_LE(std::sqrt(difference / norm), 2e-10L) << f.span[0] << " " << f.span[1] << " " << f.span[2];
}

} // namespace iga::test
