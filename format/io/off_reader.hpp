// OFF (Geomview): vertices and faces as text.
#pragma once

#include "format/io/polygon_soup.hpp"

#include <string_view>

namespace iga::io {

/// "OFF" in any case, with or without ST, C, N before it; the counts may stand in the same line, even without a blank
/// between. Extra numbers of a vertex (normal, texture, colour) and of a face (colour) are passed over where each
/// stands on a line of its own. Without such extras records may be split over lines, or share them, in any way. Faces
/// with fewer than three corners are left out, with a note.
/// @param name  how messages call the file
/// @throws InputError "name: line n: …" for what is no number, an index out of range, a file that ends early or goes
/// on behind what its header announces; for binary OFF and points in more than three dimensions
PolygonSoup read_off(std::string_view bytes, const std::string& name);

/// True where the first word is an OFF header, also with the first count behind it.
bool looks_like_off(std::string_view bytes);

} // namespace iga::io
