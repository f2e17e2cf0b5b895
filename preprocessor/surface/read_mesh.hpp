// Any supported surface file → triangles in double precision. STL (binary, ASCII), OBJ, PLY, OFF.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace iga::prep {

struct ReadMesh {
  TriangleMesh mesh;                 ///< as read (STL: three own vertices per facet); length, scaled
  std::vector<Point3> facet_normals; ///< (n_t) as stored in an STL, zero where missing or NaN; empty for other formats
  std::string format;                ///< "binary STL", "ASCII STL", "OBJ", "PLY", "OFF"
  std::string file;                  ///< as given; messages of later stages start with it
  std::string sha256;                ///< of the file's bytes
  std::vector<std::string> notes;    ///< oddities that were tolerated, one sentence each
};

/// What a surface was read from, without its facets and notes.
ReadMesh without_facets(const ReadMesh& read);

/// The format is told by the first bytes, by the name's ending where they do not tell.
/// @param scale  factor on all coordinates, > 0
/// @throws InputError for a missing, empty, truncated, damaged or foreign file, with the line where it is text
ReadMesh read_mesh(const std::filesystem::path& file, double scale = 1.0);
/// The same from the bytes of `file`, which is only named; without the hash.
ReadMesh read_mesh_bytes(std::string_view bytes, const std::filesystem::path& file, double scale = 1.0);

} // namespace iga::prep
