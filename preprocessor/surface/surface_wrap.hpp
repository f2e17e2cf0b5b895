// The last resort for a surface that no repair closes: a closed one around it.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

namespace iga::prep {

/// Closed, orientable surface without self-intersections that encloses every facet at a distance of `offset`: CGAL's
/// alpha wrapping (Portaneri et al., 2022). Holes narrower than `alpha` are bridged. Facets take the region of the
/// nearest facet.
/// @param alpha, offset  length, > 0
/// @pre has_area(mesh)
TriangleMesh wrap_surface(const TriangleMesh& mesh, double alpha, double offset);

/// Whether the corners of at least one facet do not lie on a line; decided exactly.
bool has_area(const TriangleMesh& mesh);

} // namespace iga::prep
