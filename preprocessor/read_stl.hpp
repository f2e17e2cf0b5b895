// STL, binary and ASCII, from the bytes of a file.
#pragma once

#include "preprocessor/read_mesh.hpp"

#include <string_view>

namespace iga::prep {

/// True where the text starts like an ASCII STL: "solid" in any case, followed by "facet" or "endsolid" as a word.
bool looks_like_ascii_stl(std::string_view bytes);

/// Triangles, stored normals and named solids; `format` and `notes` are filled, `sha256` is left to the caller.
/// Binary where the facet count in bytes 80–83 fits the size and the bytes do not read as ASCII STL.
/// @param name   how messages call the file
/// @param scale  factor on all coordinates
/// @throws InputError for empty, truncated and foreign bytes, numbers that are not finite, no facets
ReadMesh read_stl(std::string_view bytes, const std::string& name, double scale);

} // namespace iga::prep
