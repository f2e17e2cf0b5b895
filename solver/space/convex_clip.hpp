// Cutting convex polygons by half-spaces. Sutherland & Hodgman (1974), Reentrant polygon clipping.
#pragma once

#include "format/model/vec3.hpp"

#include <vector>

namespace iga::solve {

using ConvexPolygon = std::vector<Point3>;

/// Its length is the polygon's area, its direction the normal that the corners run anticlockwise about.
inline Point3 area_vector(const ConvexPolygon& polygon) {
  Point3 sum{};
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a)
    sum = plus(sum, cross(minus(polygon[a], polygon[0]), minus(polygon[a + 1], polygon[0])));
  return times(sum, 0.5);
}

inline double polygon_area(const ConvexPolygon& polygon) {
  return norm(area_vector(polygon));
}

/// The part of a convex polygon where `height` is at most zero; heights are linear in the position.
template <class Height> ConvexPolygon clip_convex(const ConvexPolygon& in, Height height) {
  ConvexPolygon out;
  for (std::size_t a = 0; a < in.size(); ++a) {
    const Point3 &p = in[a], &q = in[a + 1 == in.size() ? 0 : a + 1];
    const double hp = height(p), hq = height(q);
    if (hp <= 0) out.push_back(p);
    if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) out.push_back(plus(p, times(minus(q, p), hp / (hp - hq))));
  }
  return out;
}

} // namespace iga::solve
