#include "preprocessor/read_mesh.hpp"

#include "format/io/file_bytes.hpp"
#include "format/io/sha256.hpp"
#include "format/io/stl_reader.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/read_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::prep {

namespace {

/// The format by the first bytes, by the name's ending where they do not tell (OBJ has no signature).
std::string guess_format(std::string_view bytes, const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (io::looks_like_ascii_stl(bytes)) return "STL";
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
  const std::string bytes = io::read_bytes(file, "an STL, OBJ, PLY or OFF file");
  const std::string format = guess_format(bytes, file);
  ReadMesh out;
  if (format == "STL") {
    io::StlMesh stl = io::read_stl(bytes, name, scale);
    out.mesh = std::move(stl.mesh);
    out.facet_normals = std::move(stl.facet_normals);
    out.format = std::move(stl.format);
    out.notes = std::move(stl.notes);
  } else {
    out = read_polygon_file(bytes, format, name, scale);
  }
  out.file = name;
  out.sha256 = io::sha256_bytes(bytes.data(), bytes.size());
  return out;
}

} // namespace iga::prep
