// SHA-256 of bytes, files and text: how provenance names its inputs and how a matching file is recognised.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace iga::io {

/// SHA-256 of `size` bytes as 64 lower-case hexadecimal digits.
std::string sha256_bytes(const void* data, std::size_t size);
std::string sha256_text(std::string_view text);

/// SHA-256 of a file's bytes.
/// @throws InputError where the file cannot be read
std::string sha256_file(const std::filesystem::path& file);

} // namespace iga::io
