// SHA-256 of files and texts, in lower-case hex.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace iga::io {

/// 64 hex digits. @throws InputError where the file cannot be read
std::string sha256_file(const std::filesystem::path& path);
std::string sha256_text(std::string_view text);

} // namespace iga::io
