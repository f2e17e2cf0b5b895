// Seeded cubes, plates, wedges and needles in any position: every span reaches the residual.
#include "format/model/errors.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "tests/embed/surfaces.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace iga::prep {
namespace {

using namespace iga::test;

void expect_fitted(const SplineGrid& grid, const TriangleMesh& mesh, int degree, int seed) {
  const Trimming trimming = trim(grid, mesh, {});
  EXPECT_LT(trimming.worst_leak, 1e-11) << seed;
  QuadratureOptions options;
  options.moment_degree = {degree, degree, degree};
  try {
    const QuadratureResult result = build_quadrature(grid, trimming, options);
    EXPECT_LE(result.max_residual, 1e-10) << seed;
    double volume = 0;
    for (const double w : result.points.weights) volume += w;
    const double expected = trimming.exact_volume + trimming.snapped_volume;
    EXPECT_NEAR(volume, expected, 1e-9 * expected) << seed;
  } catch (const NumericalError& error) {
    ADD_FAILURE() << "seed " << seed << ", degree " << degree << ": " << error.what();
  }
}

struct Place {
  Rotation R;
  double shift;
};

Place random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> angle(0, 360), shift(0, 1);
  const double z = angle(random), y = angle(random);
  return {rotation(z, y), shift(random)};
}

TEST(ThinParts, RotatedCubesAtRandomOffsets) {
  std::mt19937 random(1);
  for (int seed = 0; seed < 20; ++seed) {
    const Place place = random_place(random);
    const TriangleMesh mesh = transformed(box({0, 0, 0}, {1, 1, 1}), place.R, {});
    expect_fitted(grid_around(mesh, 0.13, 2, place.shift), mesh, 2, seed);
  }
}

void expect_thin_parts(bool needles) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> exponent(-4, -1);
  for (int seed = 0; seed < 18; ++seed) {
    const Place place = random_place(random);
    const double size = 0.3, thin = size * std::pow(10.0, exponent(random));
    if (needles != (seed % 3 == 2)) continue;
    TriangleMesh mesh = seed % 3 == 0   ? box({0, 0, 0}, {1, 0.7, thin})
                        : seed % 3 == 1 ? prism({{0, 0}, {1, 0}, {1, thin}}, {{0, 1, 2}}, 0, 1)
                                        : box({0, 0, 0}, {1, thin, 1.3 * thin});
    mesh = transformed(mesh, place.R, {});
    for (const int degree : {2, 3}) expect_fitted(grid_around(mesh, size, degree, place.shift), mesh, degree, seed);
    if (seed % 6 < 3) expect_fitted(grid_around(mesh, 0.5, 4, place.shift), mesh, 4, seed);
  }
}

TEST(ThinParts, PlatesAndWedges) {
  expect_thin_parts(false);
}

TEST(ThinParts, Needles) {
  expect_thin_parts(true);
}

} // namespace
} // namespace iga::prep
