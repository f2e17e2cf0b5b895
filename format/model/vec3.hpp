// Vector arithmetic on Point3. Always inlined, so that every file keeps its own floating-point options.
#pragma once

#include "format/model/types.hpp"

#include <cmath>

namespace iga {

[[gnu::always_inline]] inline Point3 minus(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[gnu::always_inline]] inline Point3 plus(const Point3& a, const Point3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[gnu::always_inline]] inline Point3 times(const Point3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
[[gnu::always_inline]] inline double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[gnu::always_inline]] inline Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[gnu::always_inline]] inline double norm(const Point3& a) {
  return std::sqrt(dot(a, a));
}

/// Twice the area of the triangle (a, b, c) times its normal.
[[gnu::always_inline]] inline Point3 twice_area(const Point3& a, const Point3& b, const Point3& c) {
  return cross(minus(b, a), minus(c, a));
}

} // namespace iga
