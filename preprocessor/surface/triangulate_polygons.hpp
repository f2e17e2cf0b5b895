// Polygons → triangles.
#pragma once

#include "format/io/polygon_soup.hpp"
#include "format/model/triangle_mesh.hpp"

namespace iga::prep {

/// Polygons become triangles on the same vertices, also where they are neither convex nor planar; one region named
/// "surface".
TriangleMesh triangulate(const io::PolygonSoup& soup);

} // namespace iga::prep
