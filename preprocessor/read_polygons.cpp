#include "preprocessor/read_polygons.hpp"

#include "format/model/errors.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>
#include <algorithm>
#include <fmt/format.h>
#include <iostream>
#include <locale>
#include <sstream>

namespace iga::prep {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polygons = std::vector<std::vector<std::size_t>>;

bool read(std::istream& in, PolygonFormat format, std::vector<Kernel::Point_3>& points, Polygons& polygons) {
  switch (format) {
  case PolygonFormat::Obj:
    return CGAL::IO::read_OBJ(in, points, polygons);
  case PolygonFormat::Ply:
    return CGAL::IO::read_PLY(in, points, polygons);
  case PolygonFormat::Off:
    return CGAL::IO::read_OFF(in, points, polygons);
  }
  return false;
}

/// Triangles of a polygon with any number of corners, not necessarily convex or planar.
void append_triangles(const std::vector<std::size_t>& polygon, const std::vector<Kernel::Point_3>& points,
                      std::vector<Triangle>& triangles) {
  const auto corner = [&](std::size_t i) { return static_cast<std::int32_t>(polygon[i]); };
  if (polygon.size() == 3) {
    triangles.push_back({corner(0), corner(1), corner(2)});
    return;
  }
  std::vector<Kernel::Point_3> outline;
  for (std::size_t v : polygon) outline.push_back(points[v]);
  std::vector<CGAL::Triple<int, int, int>> patch;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(outline, std::back_inserter(patch));
  if (patch.size() + 2 != polygon.size()) {
    patch.clear();
    for (int i = 1; i + 1 < static_cast<int>(polygon.size()); ++i) patch.emplace_back(0, i, i + 1);
  }
  for (const auto& t : patch)
    triangles.push_back({corner(static_cast<std::size_t>(t.first)), corner(static_cast<std::size_t>(t.second)),
                         corner(static_cast<std::size_t>(t.third))});
}

/// The vertices and faces of an OBJ file, one per line: CGAL's reader knows neither continued lines ("\\" at the end)
/// nor the lines, points and curves that modellers add. Counts from the end (negative indices) stay right: no vertex
/// goes.
std::string vertices_and_faces(std::string_view obj) {
  std::string out;
  out.reserve(obj.size());
  std::string line;
  while (!obj.empty()) {
    const std::size_t end = std::min(obj.find('\n'), obj.size());
    std::string_view piece = obj.substr(0, end);
    obj.remove_prefix(std::min(end + 1, obj.size()));
    if (piece.ends_with('\r')) piece.remove_suffix(1);
    const bool continued = piece.ends_with('\\');
    if (continued) piece.remove_suffix(1);
    line.append(piece);
    if (continued && !obj.empty()) {
      line.push_back(' ');
      continue;
    }
    const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    const std::size_t last = std::min(line.find_first_of(" \t", first), line.size());
    const std::string_view word = std::string_view(line).substr(first, last - first);
    if (word == "v" || word == "f") out.append(line).push_back('\n');
    line.clear();
  }
  return out;
}

/// What a library prints on std::cerr while it lives, instead of the user seeing it.
class CaughtOutput {
 public:
  CaughtOutput() : before_(std::cerr.rdbuf(text_.rdbuf())) {}
  ~CaughtOutput() { std::cerr.rdbuf(before_); }
  CaughtOutput(const CaughtOutput&) = delete;
  CaughtOutput& operator=(const CaughtOutput&) = delete;
  /// Its first line.
  std::string line() const { return text_.str().substr(0, text_.str().find('\n')); }

 private:
  std::ostringstream text_;
  std::streambuf* before_;
};

} // namespace

TriangleMesh read_polygons(std::string_view bytes, PolygonFormat format, const std::string& name) {
  constexpr std::array<std::string_view, 3> names{"OBJ", "PLY", "OFF"};
  const std::string_view format_name = names[static_cast<std::size_t>(format)];
  std::vector<Kernel::Point_3> points;
  Polygons polygons;
  std::istringstream in{format == PolygonFormat::Obj ? vertices_and_faces(bytes) : std::string(bytes),
                        std::ios::binary};
  in.imbue(std::locale::classic());
  bool ok = false;
  std::string reason;
  try {
    const CaughtOutput caught;
    ok = read(in, format, points, polygons);
    if (const std::string line = caught.line(); !line.empty()) reason = fmt::format(" ({})", line);
  } catch (const std::exception& e) {
    reason = fmt::format(" ({})", e.what());
  }
  if (!ok)
    throw InputError(fmt::format("{}: cannot be read as {}{}: damaged, truncated, another format, or a coordinate that "
                                 "is not a number; export the part again",
                                 name, format_name, reason));
  TriangleMesh mesh;
  mesh.region_names = {"surface"};
  mesh.vertices.reserve(points.size());
  for (const auto& p : points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  for (std::size_t f = 0; f < polygons.size(); ++f) {
    for (std::size_t v : polygons[f])
      if (v >= points.size())
        throw InputError(
            fmt::format("{}: face {} (counted from 1) names vertex {}, the file has {}; export the part again", name,
                        f + 1, v + 1, points.size()));
    if (polygons[f].size() >= 3) append_triangles(polygons[f], points, mesh.triangles);
  }
  if (mesh.triangles.empty())
    throw InputError(fmt::format("{}: {} without any face ({} vertices); a closed surface is needed: export the part "
                                 "again as a mesh",
                                 name, format_name, points.size()));
  mesh.region.assign(mesh.triangles.size(), 0);
  return mesh;
}

} // namespace iga::prep
