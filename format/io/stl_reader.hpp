// STL, binary and ASCII, from the bytes of a file.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <string_view>

namespace iga::io {

struct StlMesh {
  TriangleMesh mesh;                 ///< three own vertices per facet; length, scaled
  std::vector<Point3> facet_normals; ///< (n_t) as stored, zero where missing or NaN
  std::string format;                ///< "binary STL", "ASCII STL"
  std::vector<std::string> notes;    ///< oddities that were tolerated, one sentence each
};

/// True where the text starts like an ASCII STL: "solid" in any case, followed by "facet" or "endsolid" as a word.
bool looks_like_ascii_stl(std::string_view bytes);

/// True where the facet count in bytes 80–83 fits the size to the byte.
bool is_whole_binary_stl(std::string_view bytes);

/// Triangles, stored normals and named solids.
/// Binary where the bytes do not read as ASCII STL. Geometry behind the announced facets is read too, with a note.
/// @param name   how messages call the file
/// @param scale  factor on all coordinates
/// @throws InputError for empty, truncated and foreign bytes, numbers that are not finite, no facets, bytes behind the
/// facets that may be geometry but cannot be read
StlMesh read_stl(std::string_view bytes, const std::string& name, double scale);

} // namespace iga::io
