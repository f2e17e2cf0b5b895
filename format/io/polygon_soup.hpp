// What OBJ, PLY and OFF files hold: points and polygons on them.
#pragma once

#include "format/model/types.hpp"

#include <string>
#include <vector>

namespace iga::io {

struct PolygonSoup {
  std::vector<Point3> points;             ///< as in the file
  std::vector<std::size_t> offsets = {0}; ///< (n_polygons + 1); polygon p has the corners [p] … [p + 1) - 1
  std::vector<std::int32_t> corners;      ///< numbers of points, from 0; at least three a polygon
  std::vector<std::string> notes;         ///< oddities that were tolerated, one sentence each

  std::size_t num_polygons() const { return offsets.size() - 1; }
};

/// Points are numbered with 32 bits.
constexpr std::size_t most_points = 2147483647;

} // namespace iga::io
