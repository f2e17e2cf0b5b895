// OBJ, PLY and OFF through CGAL.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <string>
#include <string_view>

namespace iga::prep {

enum class PolygonFormat { Obj, Ply, Off };

/// Polygons become triangles on the same vertices; one region named "surface".
/// @param name  how messages call the file
/// @throws InputError where the bytes do not read as the format or hold no face
TriangleMesh read_polygons(std::string_view bytes, PolygonFormat format, const std::string& name);

} // namespace iga::prep
