// Quadrature points against the surface of the same model: an independent proof that each lies in the solid.
#pragma once

#include "format/model/triangle_tree.hpp"
#include "format/model/trimmed_model.hpp"

#include <string>

namespace iga {

/// Points that lie outside the solid, and the deepest of them.
struct PointsOutside {
  std::int64_t count = 0;
  double weight = 0;       ///< their share of all weights
  double deepest = 0;      ///< distance to the surface, length
  Point3 where{};          ///< position
  std::int64_t point = -1; ///< its number
};

/// Winding numbers of the embedded surface about all points, by straight ways through a tree of its triangles: near
/// n log n. Points further outside than the sliver depth and rounding (surface_depth) count. Nothing of what made the
/// points is used.
/// @pre check(model) found nothing; no leak was accepted (a surface that leaks has no inside)
/// @param tree  over model.surface.mesh
PointsOutside find_points_outside(const TrimmedModel& model, const TriangleTree& tree);
PointsOutside find_points_outside(const TrimmedModel& model);

/// One sentence; empty where no point lies outside.
std::string describe(const PointsOutside& outside, const TrimmedModel& model);

} // namespace iga
