// Triangles of the embedded surface cut by half-spaces: exact areas and quadrature points of what is left of them.
#pragma once

#include "solver/space/surface_cells.hpp"

#include <functional>
#include <vector>

namespace iga::solve {

/// The side of a plane on which surface is kept: normal · (x - point) <= offset.
struct HalfSpace {
  Point3 normal{}; ///< unit, outward
  Point3 point{};  ///< length, the part's frame
  double offset = 0;
};

/// What half-spaces leave of a triangle.
struct CutTriangle {
  enum class Part { None, Some, Whole } part = Part::None;
  std::vector<Point3> polygon; ///< for Some: convex, in the triangle's orientation; length, the part's frame
};

/// A corner closer to a plane than `snap` counts as lying in it, so that a face in a plane is kept or left whole.
/// @param snap  length
CutTriangle cut_triangle(const TriangleMesh& mesh, std::size_t triangle, const std::vector<HalfSpace>& half_spaces,
                         double snap);

/// Cuts a polygon at the span faces of a grid and calls use(piece) for every piece that is no rounding of the cuts.
/// Corners are positions (length), the polygon is convex.
void for_span_pieces(const SplineGrid& grid, const std::vector<Point3>& polygon,
                     const std::function<void(const std::vector<Point3>&)>& use);

/// A quadrature point on the surface, with the cell that owns it.
struct SurfacePoint {
  std::int64_t cell = 0;
  Point3 parameter{}; ///< knot space, inside the closed span
  double weight = 0;  ///< area, length²
};

/// Adds the points of a polygon on a triangle: it is cut at the span faces, and every piece gets points exact to three
/// times the spline's degree. The weights add up to the polygon's area.
/// @param surface  of the model
void add_polygon_points(const TrimmedModel& model, const SurfaceCells& surface, std::size_t triangle,
                        const std::vector<Point3>& polygon, std::vector<SurfacePoint>& points);

} // namespace iga::solve
