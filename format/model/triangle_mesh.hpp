// A triangulated surface with named regions, and the exact moments of what it encloses.
#pragma once

#include "format/model/types.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace iga {

/// Flat triangle mesh. Closed and outward-oriented where a function says so.
struct TriangleMesh {
  std::vector<Point3> vertices;          ///< (n_v × 3); position, length
  std::vector<Triangle> triangles;       ///< (n_t × 3); vertex numbers
  std::vector<std::int32_t> region;      ///< (n_t); index into region_names
  std::vector<std::string> region_names; ///< at least one
};

/// Volume, centroid and second moments of a closed surface.
struct VolumeMoments {
  double volume = 0;                      ///< length³; negative where the surface is inside out
  Point3 centroid{};                      ///< length
  std::array<double, 6> second_moments{}; ///< ∫ r_a r_b dV about the centroid: xx yy zz xy yz zx, length⁵
};

Box3 bounding_box(const TriangleMesh& mesh);
double surface_area(const TriangleMesh& mesh);
/// Divergence theorem over the facets, relative to the bounding box's centre (no cancellation far from the origin).
VolumeMoments volume_moments(const TriangleMesh& mesh);

/// Shortest way from x to the t-th triangle, length. Right to rounding for needles too, whose normal is mostly
/// rounding.
Point3 way_to_triangle(const TriangleMesh& mesh, std::size_t t, const Point3& x);
Point3 way_to_triangle(const std::array<Point3, 3>& corners, const Point3& x);
/// Length of that way.
double distance_to_triangle(const TriangleMesh& mesh, std::size_t t, const Point3& x);

/// Shortest distance of x from a convex polygon, length; infinite where it has fewer than three corners.
double distance_to_polygon(std::span<const Point3> polygon, const Point3& x);

/// Solid angle under which a triangle is seen from x, positive where x lies behind it (Van Oosterom & Strackee 1983).
/// Over a closed surface it adds up to 4 π inside and 0 outside.
double solid_angle(const std::array<Point3, 3>& corners, const Point3& x);

} // namespace iga
