// The cylinder that a region of the surface stands for: bores, pins and shafts that supports and loads act on.
#pragma once

#include "solver/space/surface_region.hpp"

namespace iga::solve {

struct Cylinder {
  Point3 point{}; ///< on the axis, length
  Point3 axis{};  ///< unit
  double radius = 0;
  double deviation = 0; ///< largest distance of a corner of the region's triangles from it, length
  bool is_bore = false; ///< the surface faces its axis: a hole, no shaft

  /// Unit vector away from the axis.
  Point3 radial(const Point3& x) const;
  /// "radius 5 about the axis (0, 0, 1) through (1, 2, 0), …", for the report.
  std::string text() const;
};

/// Least squares over the corners of the region's triangles, which lie on the cylinder whatever the number of facets
/// (Gauss–Newton from the axis that the normals are least along).
/// @param what  opens the message: "support 'pin'"
/// @throws InputError, with the deviation, where corners lie further than 1 % of the radius from it or facets are
/// turned by more than 37° against it
Cylinder fit_cylinder(const TrimmedModel& model, const SurfaceRegion& region, const std::string& what);

} // namespace iga::solve
