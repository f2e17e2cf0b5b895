#include "preprocessor/read_mesh.hpp"

#include "format/io/sha256.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/read_polygons.hpp"
#include "preprocessor/read_stl.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>

namespace iga::prep {

namespace {

std::string read_bytes(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file; check the path", name));
  if (std::filesystem::is_directory(status))
    throw InputError(fmt::format("{}: is a folder; give an STL, OBJ, PLY or OFF file", name));
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

/// The format by the first bytes, by the name's ending where they do not tell (OBJ has no signature).
std::string guess_format(std::string_view bytes, const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (looks_like_ascii_stl(bytes)) return "STL";
  if (bytes.substr(0, 4) == "ply\n" || bytes.substr(0, 4) == "ply\r") return "PLY";
  const std::string_view first = bytes.substr(0, std::min(bytes.find_first_of(" \t\r\n"), std::size_t{10}));
  if (first == "OFF" || first == "COFF" || first == "NOFF" || first == "CNOFF" || first == "STOFF") return "OFF";
  if (ending == ".obj") return "OBJ";
  if (ending == ".ply") return "PLY";
  if (ending == ".off") return "OFF";
  return "STL";
}

ReadMesh read_polygon_file(std::string_view bytes, const std::string& format, const std::string& name, double scale) {
  const PolygonFormat which = format == "OBJ"   ? PolygonFormat::Obj
                              : format == "PLY" ? PolygonFormat::Ply
                                                : PolygonFormat::Off;
  ReadMesh out;
  out.format = format;
  out.mesh = read_polygons(bytes, which, name);
  for (std::size_t v = 0; v < out.mesh.vertices.size(); ++v)
    for (double& x : out.mesh.vertices[v]) {
      x *= scale;
      if (!std::isfinite(x))
        throw InputError(
            fmt::format("{}: vertex {} (counted from 1) is not a finite position; export the part again", name, v + 1));
    }
  return out;
}

} // namespace

ReadMesh read_mesh(const std::filesystem::path& file, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw InputError(fmt::format("scale is {}; it must be a positive number", scale));
  const std::string name = file.string();
  const std::string bytes = read_bytes(file);
  const std::string format = guess_format(bytes, file);
  ReadMesh out = format == "STL" ? read_stl(bytes, name, scale) : read_polygon_file(bytes, format, name, scale);
  out.file = name;
  out.sha256 = io::sha256_bytes(bytes.data(), bytes.size());
  return out;
}

} // namespace iga::prep
