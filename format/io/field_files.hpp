// Fields of explicit analyses: files of their own beside the results file, so that what grows step by step is only ever
// added to by new files.
#pragma once

#include "format/model/results.hpp"

#include <filesystem>

namespace iga::io {

/// Meshes and functions of all bodies; replaces an older file. The file appears whole or not at all.
/// @throws InputError with the system's reason
void write_body_meshes(const std::filesystem::path& path, const std::vector<BodyMesh>& bodies);

/// Fields of all bodies at one time, likewise.
void write_fields(const std::filesystem::path& path, double time, const std::vector<BodyFields>& bodies);

} // namespace iga::io
