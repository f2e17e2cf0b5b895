// Fields of explicit analyses and of several bodies: files of their own beside the results file, so that what grows
// step by step is only ever added to by new files.
#pragma once

#include "format/model/results.hpp"

#include <filesystem>

namespace iga::io {

/// The folder of the field files: out.h5 → out_fields.
std::filesystem::path fields_folder(const std::filesystem::path& results);
/// Names relative to the folder of the results file: out_fields/out_bodies.h5, and of a step (from 0)
/// out_fields/out_0001.h5.
std::string bodies_file(const std::filesystem::path& results);
std::string field_file(const std::filesystem::path& results, std::size_t step);
/// Removes the files of this step and later ones that an earlier run left: no list names them.
void remove_fields_from(const std::filesystem::path& results, std::size_t step);

/// Writes results.parts into field files and lists them in results.fields.
/// @throws InputError with the system's reason
void write_parts(const std::filesystem::path& path, Results& results);

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
