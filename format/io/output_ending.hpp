// An output named like a table, a picture or a geometry would hold HDF5 all the same: refused before the work.
#pragma once

#include <filesystem>

namespace iga::io {

/// @throws InputError where the name ends like a file of another kind (.csv, .vtu, .json, .stl …), with what to do
void refuse_foreign_ending(const std::filesystem::path& output);

} // namespace iga::io
