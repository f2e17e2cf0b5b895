#include "preprocessor/surface/read_mesh.hpp"

#include "format/io/file_bytes.hpp"
#include "format/io/foreign_file.hpp"
#include "format/io/obj_reader.hpp"
#include "format/io/off_reader.hpp"
#include "format/io/ply_reader.hpp"
#include "format/io/sha256.hpp"
#include "format/io/stl_reader.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/surface/triangulate_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::prep {

namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

/// The format by the first bytes, by the name's ending where they do not tell (OBJ has no signature).
std::string guess_format(std::string_view bytes, const std::filesystem::path& file) {
  if (io::looks_like_ascii_stl(bytes)) return "STL";
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return "PLY";
  if (io::looks_like_off(bytes)) return "OFF";
  if (!io::is_whole_binary_stl(bytes) && !io::recognise_content(bytes)) {
    const std::string ending = ending_of(file);
    if (ending == ".obj") return "OBJ";
    if (ending == ".ply") return "PLY";
    if (ending == ".off") return "OFF";
  }
  return "STL";
}

ReadMesh read_stl_bytes(std::string_view bytes, const std::filesystem::path& file, double scale) {
  io::refuse_foreign(bytes, file);
  io::StlMesh stl = io::read_stl(bytes, file.string(), scale);
  ReadMesh out;
  out.mesh = std::move(stl.mesh);
  out.facet_normals = std::move(stl.facet_normals);
  out.format = std::move(stl.format);
  out.notes = std::move(stl.notes);
  return out;
}

ReadMesh read_polygon_bytes(std::string_view bytes, const std::string& format, const std::string& name, double scale) {
  io::PolygonSoup soup = format == "OBJ"   ? io::read_obj(bytes, name)
                         : format == "PLY" ? io::read_ply(bytes, name)
                                           : io::read_off(bytes, name);
  if (soup.num_polygons() == 0)
    throw InputError(fmt::format("{}: {} without any face ({} vertices); a closed surface is needed: export the part "
                                 "again as a mesh",
                                 name, format, soup.points.size()));
  ReadMesh out;
  out.format = format;
  out.mesh = triangulate(soup);
  for (std::size_t v = 0; v < out.mesh.vertices.size(); ++v)
    for (double& x : out.mesh.vertices[v]) {
      x *= scale;
      if (!std::isfinite(x))
        throw InputError(fmt::format("{}: vertex {} (counted from 1) times the scale {} is not a finite position", name,
                                     v + 1, scale));
    }
  out.notes = std::move(soup.notes);
  return out;
}

} // namespace

ReadMesh without_facets(const ReadMesh& read) {
  return {{}, {}, read.format, read.file, read.sha256, {}};
}

ReadMesh read_mesh_bytes(std::string_view bytes, const std::filesystem::path& file, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw InputError(fmt::format("scale is {}; it must be a positive number", scale));
  const std::string format = guess_format(bytes, file);
  ReadMesh out =
      format == "STL" ? read_stl_bytes(bytes, file, scale) : read_polygon_bytes(bytes, format, file.string(), scale);
  out.file = file.string();
  return out;
}

ReadMesh read_mesh(const std::filesystem::path& file, double scale) {
  const std::string bytes = io::read_bytes(file, "an STL, OBJ, PLY or OFF file");
  ReadMesh out = read_mesh_bytes(bytes, file, scale);
  out.sha256 = io::sha256_bytes(bytes.data(), bytes.size());
  return out;
}

} // namespace iga::prep
