// Seeded tubes, cylinders, plates, boxes and hollow shells in any position, and what every rule on them must fulfil:
// no point outside. The winding number here shares nothing with the product: solid angles of all triangles.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <cstdint>
#include <string>

namespace iga::test {

struct RandomSolid {
  TriangleMesh mesh; ///< closed, outward-oriented
  SplineGrid grid;
  int degree = 1;   ///< 1 … 4
  std::string name; ///< kind, walls and grid, for messages
};

/// Walls between 1e-3 and 1 span thick, 3 to 8 spans along the longest side.
RandomSolid random_solid(std::uint64_t seed);

/// Winding number of a closed surface about x: Σ solid angles / 4π (Van Oosterom & Strackee 1983).
double winding_number(const TriangleMesh& mesh, const Point3& x);

struct OutsidePoints {
  std::int64_t points = 0;    ///< looked at
  std::int64_t outside = 0;   ///< further outside than `allowed`
  double deepest = 0;         ///< largest distance of such a point to the surface, in spans
  double weight = 0;          ///< their share of the volume
  double moment_residual = 0; ///< largest one of a span
  double least_weight = 0;    ///< smallest weight / span volume
  double volume_error = 0;    ///< |Σ weights - exact|, relative
};

/// Trims, fits, reduces (`minimal`) or fits alone (`nnls`), and looks at every point.
/// @param allowed  distance outside that rounding and snapping may leave, in spans
OutsidePoints find_outside_points(const RandomSolid& solid, const std::string& trimmed_rule, double allowed = 1e-9);

} // namespace iga::test
