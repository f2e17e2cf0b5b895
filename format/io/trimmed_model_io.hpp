// The interchange file: TrimmedModel ↔ HDF5 as schema/README.md describes it.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <filesystem>

namespace iga::io {

/// Writes the file whole or not at all: beside its final place, synced, renamed. An old file stays until then.
/// @throws InputError naming the folder and the system's reason (no permission, full disk)
void write_model(const std::filesystem::path& path, const TrimmedModel& model);

/// Reads a file and checks all that schema/README.md promises.
/// @throws InputError for a missing file
/// @throws FormatError naming file, path, what was found and what was expected; all problems of check() in one message
TrimmedModel read_model(const std::filesystem::path& path);

/// Reads a file whose groups, datasets, types, shapes, knots and control points are as they should be, without
/// check(model): for a program that lists every problem itself. Throws as read_model.
TrimmedModel load_model(const std::filesystem::path& path);

/// The label of lengths alone; throws as read_model.
std::string read_length_unit(const std::filesystem::path& path);

/// Who made the file from what; reads only the root's and /provenance's attributes and small tables.
/// Throws as read_model; fields that a foreign producer left out stay empty.
Provenance read_provenance(const std::filesystem::path& path);

} // namespace iga::io
