#include "samples/foam_part.hpp"

#include "samples/mesh_implicit.hpp"
#include "samples/solids.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iga::samples {
namespace {

constexpr double width = 308.6, height = 147.4, depth = 257.2; // along x, y, z; mm; off the 10 mm raster on purpose
constexpr double wall = 15.0, front_wall = 15.0;

/// Intersection of two distance functions; where they meet at a right angle the edge becomes an arc of radius r.
double meet(double a, double b, double r) {
  return std::min(std::max(a, b), -r) + std::hypot(std::max(a + r, 0.0), std::max(b + r, 0.0));
}
double cut(double a, double tool, double r) {
  return meet(a, -tool, r);
}
double slab(double x, double low, double high) {
  return std::abs(x - (low + high) / 2) - (high - low) / 2;
}
double bore(double x, double y, double cx, double cy, double radius) {
  return std::hypot(x - cx, y - cy) - radius;
}

/// The front, `inset` behind the visible one: a wide arc over x, bevelled towards both ends of z.
double front(const Point3& x, double inset, double edge) {
  constexpr double bow = 380.0, bevel_length = 40.0, bevel_angle = 38.0 * std::numbers::pi / 180;
  const auto bevel = [&](double from_end) {
    return (x[1] - height) * std::cos(bevel_angle) + (bevel_length - from_end) * std::sin(bevel_angle) + inset;
  };
  const double arc = bore(x[0], x[1], width / 2, height - bow, bow - inset);
  return meet(meet(arc, bevel(x[2]), edge), bevel(depth - x[2]), edge);
}

double solid(const Point3& p) {
  const auto [x, y, z] = p;
  const double outline = meet(slab(x, 0, width), slab(z, 0, depth), 30);
  double f = meet(outline, meet(front(p, 0, 20), -y, 8), 8);

  constexpr double middle = 63.6; // width of the pockets in the middle
  const double rib_low = (width - middle) / 2 - wall, rib_high = (width + middle) / 2 + wall;
  const double floor = front(p, front_wall, 12);
  for (const auto& [x_low, x_high] :
       {Point2{wall, rib_low}, {rib_low + wall, rib_high - wall}, {rib_high, width - wall}})
    for (const auto& [z_low, z_high] : {Point2{wall, (depth - wall) / 2}, {(depth + wall) / 2, depth - wall}})
      f = cut(f, meet(meet(slab(x, x_low, x_high), slab(z, z_low, z_high), 14), floor, 10), 6);

  for (const double side : {-1.0, 1.0}) {
    f = cut(f, bore(z, y, depth / 2 + 60 * side, 60, 30), 4); // along x
    f = cut(f, bore(x, y, width / 2 + 93 * side, 60, 27), 4); // along z
    for (const double end : {-1.0, 1.0})                      // along y, through the front
      f = cut(f, bore(x, z, width / 2 + 100 * side, depth / 2 + 60 * end, 33), 5);
  }
  f = cut(f, bore(x, z, width / 2, depth / 2 - 60, 27), 5);
  const double notch = meet(slab(x, width / 2 - 24, width / 2 + 24), depth - 70 - z, 12);
  return cut(f, notch, 6);
}

} // namespace

TriangleMesh foam_part() {
  return mesh_implicit(solid, {.inside = {width / 2, height - front_wall / 2, depth / 2},
                               .radius = 400,
                               .min_angle = 26,
                               .max_size = 8,
                               .max_distance = 0.22});
}

} // namespace iga::samples
