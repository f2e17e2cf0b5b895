// Vertices that lie on the inside of a neighbour's edge (T-junctions): where a mesher refined one side of an edge only.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

#include <cstdint>

namespace iga::prep {

/// Splits facets along open edges at the vertices of other open edges that lie on them, so that both sides share the
/// same edges. No vertex moves: the shape changes by `tolerance` at most.
/// @param tolerance  largest distance of a vertex from the edge that it splits, length
/// @return number of facets that were split
std::int64_t split_at_junctions(Surface& surface, double tolerance);

} // namespace iga::prep
