// Facets that bound no material: fins, walls inside a body, open sheets beside a closed body.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

namespace iga::prep {

struct DroppedSheets {
  std::int64_t sheets = 0; ///< edge-connected patches
  std::int64_t facets = 0;
  double area = 0; ///< length²
  Point3 where{};  ///< a corner of the first one
};

/// Drops, smallest first, patches whose removal leaves fewer open edges and opens none: fins (attached along one
/// border, free along another), one wall that parts a body (the choice that leaves the largest volume), and open shells
/// beside closed ones that a lid could close only with more than half of their own area.
DroppedSheets drop_free_sheets(Surface& surface);

} // namespace iga::prep
