// Writes STL and makes sure that what was written is a sound solid.
#pragma once

#include "samples/parts.hpp"

#include <filesystem>

namespace iga::samples {

/// The mesh with the coordinates that an STL file of this kind holds: float32 for binary ones, unchanged for text.
/// Triangles that rounding made degenerate are flipped or collapsed away.
TriangleMesh as_stored(TriangleMesh mesh, StlKind kind);

/// @throws std::runtime_error unless the surface is closed, manifold, free of self-intersections and degenerate
///         triangles, and bounds a volume with all its shells oriented accordingly
void require_sound(const TriangleMesh& mesh, const std::string& name);

/// Same mesh, same bytes. @throws std::runtime_error where the file cannot be written
void write_stl(const TriangleMesh& mesh, const std::string& name, StlKind kind, const std::filesystem::path& file);

} // namespace iga::samples
