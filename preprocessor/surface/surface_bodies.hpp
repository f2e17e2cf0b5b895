// A prepared surface of several bodies → one surface for each.
#pragma once

#include "format/model/triangle_mesh.hpp"

namespace iga::prep {

/// Each outer shell with the cavities in it, in the order of their first facets; regions without a facet are left out.
/// @param mesh  closed, outward-oriented, welded, as prepare_surface gives it
std::vector<TriangleMesh> split_into_bodies(const TriangleMesh& mesh);

} // namespace iga::prep
