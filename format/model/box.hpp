// Boxes along the axes: around points, against each other, how far away.
#pragma once

#include "format/model/types.hpp"

#include <algorithm>
#include <span>

namespace iga {

/// Closed boxes: those that touch overlap.
inline bool overlap(const Box3& a, const Box3& b) {
  return a.lower[0] <= b.upper[0] && b.lower[0] <= a.upper[0] && a.lower[1] <= b.upper[1] && b.lower[1] <= a.upper[1] &&
         a.lower[2] <= b.upper[2] && b.lower[2] <= a.upper[2];
}

/// The smallest box that holds both.
inline Box3 join(const Box3& a, const Box3& b) {
  Box3 box;
  for (std::size_t d = 0; d < 3; ++d) {
    box.lower[d] = std::min(a.lower[d], b.lower[d]);
    box.upper[d] = std::max(a.upper[d], b.upper[d]);
  }
  return box;
}

/// The smallest box that holds all points. @pre there is one
inline Box3 bounding_box(std::span<const Point3> points) {
  Box3 box{points.front(), points.front()};
  for (const Point3& x : points.subspan(1)) box = join(box, {x, x});
  return box;
}

/// Of a place from a box, 0 inside.
inline double squared_distance(const Box3& box, const Point3& x) {
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const double outside = std::max({box.lower[d] - x[d], x[d] - box.upper[d], 0.0});
    sum += outside * outside;
  }
  return sum;
}

} // namespace iga
