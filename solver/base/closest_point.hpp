// Nearest points of triangles and segments, with the feature they lie on.
#pragma once

#include "format/model/types.hpp"

namespace iga::solve {

struct ClosestOnTriangle {
  Point3 weight{};   ///< barycentric, all in [0, 1]
  Point3 position{}; ///< length
  double distance2 = 0;
  int feature = 0; ///< 0: inside; 1, 2, 3: edge from corner 0, 1, 2 to the next; 4, 5, 6: corner 0, 1, 2
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: the Voronoi region decides.
ClosestOnTriangle closest_on_triangle(const Point3& x, const Point3& a, const Point3& b, const Point3& c);

struct ClosestOfSegments {
  double s = 0, t = 0;   ///< position along the first and second segment, in [0, 1]
  bool interior = false; ///< strictly inside both and not (nearly) parallel
};
ClosestOfSegments closest_of_segments(const Point3& a, const Point3& b, const Point3& c, const Point3& d);

} // namespace iga::solve
