// A whole file as bytes.
#pragma once

#include <filesystem>
#include <string>

namespace iga::io {

/// @param wanted  what should be given in the place of a folder: "an STL file"
/// @throws InputError for a file that is missing, a folder, empty or cannot be read
std::string read_bytes(const std::filesystem::path& file, const std::string& wanted);

} // namespace iga::io
