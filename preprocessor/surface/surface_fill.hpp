// Fills holes with new facets between the existing vertices.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

namespace iga::prep {

struct Filling {
  std::int64_t holes = 0;
  std::int64_t facets = 0; ///< added
  double area = 0;         ///< added, length²
  Point3 where{};          ///< a vertex of the first hole
};

/// Closes every loop of unbalanced edges: CGAL's hole triangulation (Liepa, 2003: smallest dihedral angles, then area).
/// New facets have no stored normal and go to the region "repaired". Afterwards every edge is balanced.
/// @pre neighbours agree about the outside (orient_facets)
Filling fill_holes(Surface& surface);

} // namespace iga::prep
