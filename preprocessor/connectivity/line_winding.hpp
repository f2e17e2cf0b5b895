// An independent check of a surface: winding numbers along regular lines through the grid.
#pragma once

#include "preprocessor/trim/trim.hpp"

namespace iga::prep {

struct WindingReport {
  std::int64_t num_lines = 0;
  std::int64_t num_crossings = 0;
  double bad_length = 0;      ///< summed length with a winding number other than 0 or 1, length
  std::int64_t bad_lines = 0; ///< lines with such a stretch longer than the sliver depth, or that do not end at 0
  int worst_winding = 0;      ///< the winding number furthest from 0 … 1; 1 where lines merely do not end at 0
  Point3 where{};             ///< position of the worst stretch's middle
};

/// Shoots (max degree + 2)² lines per row along u, v and w through every row of spans that holds a touched span.
/// Works slab by slab: memory stays proportional to the touched spans.
/// @pre the mesh lies inside the grid's box; trimming belongs to both
WindingReport check_winding(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                            double sliver_tolerance);

} // namespace iga::prep
