// CAD file → all of its solids, tessellated, with faces, edges, names, units and places.
#pragma once

#include "preprocessor/cad/cad_model.hpp"

#include <filesystem>

namespace iga::prep {

/// @throws InputError for a file that cannot be read whole, holds no solid, or faces that cannot be tessellated
CadModel read_cad(const std::filesystem::path& file, const CadOptions& options);

} // namespace iga::prep
