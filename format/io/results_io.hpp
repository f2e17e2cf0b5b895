// The results file: Results ↔ HDF5 as schema/README.md describes it.
#pragma once

#include "format/model/results.hpp"

#include <filesystem>

namespace iga::io {

/// Fails early, before hours of work: may `path` be written?
/// @throws InputError where it exists and `force` is not set, or where no file can be made in its folder
void check_results_target(const std::filesystem::path& path, bool force);

/// Writes the file whole or not at all: beside its final place, synced, renamed. An old file stays until then.
/// @throws InputError as check_results_target, and with the system's reason (no permission, full disk)
void write_results(const std::filesystem::path& path, const Results& results, bool force);

/// Does the file call itself a results file? @throws InputError, FormatError for one that is missing or no HDF5 file
bool holds_results(const std::filesystem::path& path);

/// Reads a file and checks shapes, finite numbers and indices.
/// @throws InputError for a missing file
/// @throws FormatError naming file, path, what was found and what was expected
Results read_results(const std::filesystem::path& path);

} // namespace iga::io
