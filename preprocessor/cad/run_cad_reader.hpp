// Runs the CAD reader (igaprep-cad, beside igaprep) on a file.
#pragma once

#include "preprocessor/cad/cad_model.hpp"

#include <filesystem>
#include <functional>

namespace iga::prep {

/// @param stop  asked every few milliseconds: true ends the reader, and this function by an empty model
/// @throws InputError for what the reader refuses, for a file that brings it down, and where this igaprep was built
/// without OpenCASCADE
CadModel run_cad_reader(const std::filesystem::path& file, const CadOptions& options,
                        const std::function<bool()>& stop);

} // namespace iga::prep
