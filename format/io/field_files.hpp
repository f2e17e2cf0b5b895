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

/// Reads back what write_body_meshes wrote: the bodies of these names, in their order.
/// @throws InputError for a missing file, FormatError naming file, path, what was found and what was expected
std::vector<BodyMesh> read_body_meshes(const std::filesystem::path& path, const std::vector<std::string>& names);
/// The same of write_fields; `meshes` as read.
std::vector<BodyFields> read_fields(const std::filesystem::path& path, const std::vector<BodyMesh>& meshes);

} // namespace iga::io
