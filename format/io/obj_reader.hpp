// OBJ (Wavefront): vertices and faces.
#pragma once

#include "format/io/polygon_soup.hpp"

#include <string_view>

namespace iga::io {

/// Lines may be continued by a backslash. Groups, materials, normals, textures, lines, points and free-form geometry
/// are passed over; an unknown keyword is refused, since a damaged "v" would move all numbers after it.
/// Faces with fewer than three corners are left out, with a note.
/// @param name  how messages call the file
/// @throws InputError "name: line n: …" for what is no number, an index that is zero, no number or out of range
PolygonSoup read_obj(std::string_view bytes, const std::string& name);

} // namespace iga::io
