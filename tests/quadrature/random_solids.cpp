#include "tests/quadrature/random_solids.hpp"

#include "format/model/vec3.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "preprocessor/trim/make_grid.hpp"
#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <random>

namespace iga::test {

namespace {

/// Numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  int pick(int count) { return static_cast<int>(between(0, count)); }

 private:
  std::mt19937_64 bits_;
};

// Ring of n corners at radius `outer`, with a hole of radius `inner` where that is above 0, from z = 0 to `height`.
TriangleMesh tube(int n, double outer, double inner, double height) {
  TriangleMesh m;
  const bool hollow = inner > 0;
  const auto ring = [&](double r, double z) {
    const auto first = static_cast<std::int32_t>(m.vertices.size());
    for (int a = 0; a < n; ++a) {
      const double angle = 2 * std::numbers::pi * a / n;
      m.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    return first;
  };
  // Quadrilaterals between two rings, outward on the left of the way from `low` to `high` seen anticlockwise.
  const auto join_rings = [&](std::int32_t low, std::int32_t high) {
    for (std::int32_t a = 0; a < n; ++a) {
      const std::int32_t b = (a + 1) % n;
      m.triangles.push_back({low + a, low + b, high + b});
      m.triangles.push_back({low + a, high + b, high + a});
    }
  };
  const std::int32_t bottom = ring(outer, 0), top = ring(outer, height);
  join_rings(bottom, top);
  if (hollow) {
    const std::int32_t inner_bottom = ring(inner, 0), inner_top = ring(inner, height);
    join_rings(inner_top, inner_bottom);
    join_rings(top, inner_top);
    join_rings(inner_bottom, bottom);
  } else {
    for (std::int32_t a = 1; a + 1 < n; ++a) {
      m.triangles.push_back({bottom, bottom + a + 1, bottom + a});
      m.triangles.push_back({top, top + a, top + a + 1});
    }
  }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"tube"};
  return m;
}

} // namespace

RandomSolid random_solid(std::uint64_t seed) {
  Random random(seed);
  for (int skip = 0; skip < 8; ++skip) random.between(0, 1);
  const int spans = 3 + random.pick(6);
  const double h = 1.0 / spans; // the longest side is about 1
  const double wall = h * std::pow(10.0, random.between(-3, 0));
  RandomSolid out;
  out.degree = 1 + random.pick(4);
  const int corners = 3 + random.pick(38);
  const double radius = random.between(0.15, 0.5), height = random.between(0.2, 1.0);
  const char* kind = "";
  switch (random.pick(7)) {
  case 0:
  case 1:
    kind = "tube";
    out.mesh = tube(corners, radius, std::max(radius - wall, 0.05 * radius), height);
    break;
  case 2:
    kind = "cylinder";
    out.mesh = tube(corners, random.pick(2) ? radius : wall, 0, height);
    break;
  case 3:
    kind = "plate";
    out.mesh = box({0, 0, 0}, {1, random.between(0.2, 1), wall});
    break;
  case 4: {
    kind = "hollow box";
    const Point3 side{1, random.between(0.4, 1), random.between(0.3, 1)};
    out.mesh = join(
        {box({0, 0, 0}, side), flipped(box({wall, wall, wall}, {side[0] - wall, side[1] - wall, side[2] - wall}))});
    break;
  }
  case 5: {
    kind = "hollow sphere";
    const int levels = 2 + random.pick(2);
    out.mesh = join({sphere({0, 0, 0}, 0.5, levels), flipped(sphere({0, 0, 0}, std::max(0.5 - wall, 0.1), levels))});
    break;
  }
  default:
    kind = "needle";
    out.mesh = box({0, 0, 0}, {1, wall, wall * random.between(0.3, 3)});
  }
  const bool turned = random.pick(8) != 0; // one in eight along the axes of the grid
  if (turned) out.mesh = transformed(out.mesh, rotation(random.between(0, 360), random.between(0, 360)), {});
  prep::GridOptions options;
  options.degree = {out.degree, out.degree, out.degree};
  options.spans = {spans};
  out.grid = prep::make_grid(out.mesh, options).grid;
  out.name = fmt::format("seed {}: {}, {} triangles, wall {:.3g} spans, {} spans, degree {}{}", seed, kind,
                         out.mesh.triangles.size(), wall / h, spans, out.degree, turned ? ", turned" : "");
  return out;
}

double winding_number(const TriangleMesh& mesh, const Point3& x) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    std::array<Point3, 3> r;
    std::array<double, 3> length;
    for (std::size_t a = 0; a < 3; ++a) {
      r[a] = minus(mesh.vertices[static_cast<std::size_t>(t[a])], x);
      length[a] = norm(r[a]);
    }
    const double volume = dot(r[0], cross(r[1], r[2]));
    const double rest = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] + dot(r[1], r[2]) * length[0] +
                        dot(r[2], r[0]) * length[1];
    sum += std::atan2(volume, rest);
  }
  return sum / (2 * std::numbers::pi);
}

OutsidePoints find_outside_points(const RandomSolid& solid, const std::string& trimmed_rule, double allowed) {
  const prep::Trimming trimming = prep::trim(solid.grid, solid.mesh, {});
  prep::QuadratureOptions options;
  options.trimmed_rule = trimmed_rule;
  options.moment_degree = {solid.degree, solid.degree, solid.degree};
  options.interior_rule = "ggq";
  const prep::QuadratureResult result = prep::build_quadrature(solid.grid, trimming, options);
  const IntegrationPoints& points = result.points;
  OutsidePoints out;
  out.points = static_cast<std::int64_t>(points.weights.size());
  out.moment_residual = result.max_residual;
  out.least_weight = std::numeric_limits<double>::infinity();
  const Point3 sides = solid.grid.span_size();
  const double h = std::max({sides[0], sides[1], sides[2]});
  double volume = 0;
  for (std::size_t q = 0; q < points.weights.size(); ++q) {
    volume += points.weights[q];
    out.least_weight = std::min(out.least_weight, points.weights[q] / solid.grid.span_volume());
    const Point3 x =
        solid.grid.to_position({points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]});
    if (winding_number(solid.mesh, x) > 0.5) continue;
    double away = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < solid.mesh.triangles.size(); ++t)
      away = std::min(away, distance_to_triangle(solid.mesh, t, x));
    if (away <= allowed * h) continue;
    ++out.outside;
    out.weight += points.weights[q];
    out.deepest = std::max(out.deepest, away / h);
  }
  const double expected = trimming.exact_volume + trimming.snapped_volume;
  out.volume_error = std::abs(volume - expected) / expected;
  out.weight /= volume;
  return out;
}

} // namespace iga::test
