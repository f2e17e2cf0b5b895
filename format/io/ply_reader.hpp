// PLY (Stanford): ASCII, binary little and big endian.
#pragma once

#include "format/io/polygon_soup.hpp"

#include <string_view>

namespace iga::io {

/// Points from element "vertex" (x, y, z of any type), polygons from element "face" (list vertex_indices or
/// vertex_index of any type); all else is passed over. Numbers of an ASCII file get the precision that the header
/// declares. Faces with fewer than three corners are left out, with a note.
/// @param name  how messages call the file
/// @throws InputError "name: line n: …" or "name: face n …" for a bad header or number, an index out of range, a file
/// that ends early or goes on behind what its header announces
PolygonSoup read_ply(std::string_view bytes, const std::string& name);

} // namespace iga::io
