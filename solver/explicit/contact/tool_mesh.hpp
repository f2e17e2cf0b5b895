// Rigid tools from STL files, and the mass of solid ones.
#pragma once

#include "solver/explicit/contact/rigid_body.hpp"

#include <filesystem>

namespace iga::solve {

struct ToolMesh {
  MeshShape shape;   ///< relative to its centre of volume
  Point3 centre{};   ///< length, in the file's frame
  double volume = 0; ///< length³
};

/// @param scale  factor on all coordinates
/// @throws InputError for files that cannot be read, surfaces that are open or inside out
ToolMesh read_tool(const std::filesystem::path& file, double scale = 1);
/// The same from triangles; `name` opens messages.
ToolMesh make_tool(const TriangleMesh& mesh, const std::string& name);

/// Mass and inertia of the tool filled with a density (mass/length³).
FreeMotion solid_tool(const ToolMesh& tool, double density);

} // namespace iga::solve
