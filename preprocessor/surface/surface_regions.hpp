// Numbered regions: smooth patches between sharp edges, so that a load can be put on "the top face".
#pragma once

#include "format/model/triangle_mesh.hpp"

namespace iga::prep {

/// Splits every region into patches of facets that are connected across two-facet edges with an angle between their
/// normals of at most `degrees`. Patches are numbered by their first facet: "lid" with three patches becomes "lid/1" …
/// "lid/3"; a region of one patch keeps its name.
void split_regions(TriangleMesh& mesh, double degrees);

} // namespace iga::prep
