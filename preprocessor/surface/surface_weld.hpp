// Joins vertices that mean the same point and removes facets that carry no surface; the shape stays.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

namespace iga::prep {

/// Joins vertices with equal coordinates (−0 equals 0). Numbers follow the first appearance in the file.
/// @return number of vertices that went
std::int64_t weld_equal_vertices(Surface& surface);

/// How far near vertices were joined to close the surface.
struct NearWeld {
  std::int64_t joined = 0; ///< vertices that went
  double tolerance = 0;    ///< length; 0 where nothing was joined
};

/// Joins vertices on open edges that lie within the smallest of 1e-9, 1e-8, 1e-7, 1e-6 · diagonal that leaves the
/// fewest open edges. Vertices away from open edges never move, so small facets and thin walls of a closed part stay.
NearWeld weld_near_vertices(Surface& surface);

/// Facets with a repeated vertex. @return number removed
std::int64_t drop_collapsed_facets(Surface& surface);

struct DuplicateFacets {
  std::int64_t repeated = 0;  ///< surplus copies in the same orientation, removed
  std::int64_t cancelled = 0; ///< facets removed in opposite pairs
};

/// Facets on the same three vertices: of equal copies one stays, opposite pairs go (walls between touching bodies)
/// unless the surface would open there. Copies that a closed surface needs (an edge would lose its balance) stay.
DuplicateFacets drop_duplicate_facets(Surface& surface);

/// Facets whose area is below 1e-14 · diagonal² although their vertices differ. They close T-junctions, so they stay.
std::int64_t count_needle_facets(const TriangleMesh& mesh);

} // namespace iga::prep
