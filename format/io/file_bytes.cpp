#include "format/io/file_bytes.hpp"

#include "format/model/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>

namespace iga::io {

std::string read_bytes(const std::filesystem::path& file, const std::string& wanted) {
  const std::string name = file.string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file; check the path", name));
  if (std::filesystem::is_directory(status)) throw InputError(fmt::format("{}: is a folder; give {}", name, wanted));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!in) throw InputError(fmt::format("{}: cannot be opened: {}", name, std::strerror(errno)));
  std::string bytes;
  const auto size = std::filesystem::file_size(file, error);
  constexpr std::size_t chunk = std::size_t{1} << 20;
  std::size_t used = 0;
  // One read where the size is known (one byte more, to see the end); growing chunks for pipes.
  bytes.resize(error || size == 0 ? chunk : static_cast<std::size_t>(size) + 1);
  while (true) {
    const std::size_t got = std::fread(bytes.data() + used, 1, bytes.size() - used, in.get());
    used += got;
    if (used < bytes.size()) break;
    bytes.resize(2 * bytes.size());
  }
  if (std::ferror(in.get())) throw InputError(fmt::format("{}: reading failed: {}", name, std::strerror(errno)));
  bytes.resize(used);
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty (0 bytes); export the part again", name));
  return bytes;
}

} // namespace iga::io
