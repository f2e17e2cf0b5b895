#include "solver/base/closest_point.hpp"

#include "format/model/vec3.hpp"

namespace iga::solve {

namespace {

ClosestOnTriangle result(const Point3& x, const Point3& a, const Point3& b, const Point3& c, const Point3& weight,
                         int feature) {
  ClosestOnTriangle out{weight, {}, 0, feature};
  for (std::size_t d = 0; d < 3; ++d) out.position[d] = weight[0] * a[d] + weight[1] * b[d] + weight[2] * c[d];
  const Point3 gap = minus(x, out.position);
  out.distance2 = dot(gap, gap);
  return out;
}

} // namespace

ClosestOnTriangle closest_on_triangle(const Point3& x, const Point3& a, const Point3& b, const Point3& c) {
  const Point3 ab = minus(b, a), ac = minus(c, a), ax = minus(x, a);
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0 && d2 <= 0) return result(x, a, b, c, {1, 0, 0}, 4);
  const Point3 bx = minus(x, b);
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0 && d4 <= d3) return result(x, a, b, c, {0, 1, 0}, 5);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return result(x, a, b, c, {1 - v, v, 0}, 1);
  }
  const Point3 cx = minus(x, c);
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0 && d5 <= d6) return result(x, a, b, c, {0, 0, 1}, 6);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return result(x, a, b, c, {1 - w, 0, w}, 3);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return result(x, a, b, c, {0, 1 - w, w}, 2);
  }
  const double scale = 1 / (va + vb + vc), v = vb * scale, w = vc * scale;
  return result(x, a, b, c, {1 - v - w, v, w}, 0);
}

ClosestOfSegments closest_of_segments(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  // Sines of angles below this make the common normal meaningless.
  constexpr double least_sine2 = 1e-4;
  const Point3 u = minus(b, a), v = minus(d, c), w = minus(a, c);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double determinant = uu * vv - uv * uv;
  ClosestOfSegments out;
  if (!(determinant > least_sine2 * uu * vv)) return out;
  out.s = (uv * vw - vv * uw) / determinant;
  out.t = (uu * vw - uv * uw) / determinant;
  out.interior = out.s > 0 && out.s < 1 && out.t > 0 && out.t < 1;
  return out;
}

} // namespace iga::solve
