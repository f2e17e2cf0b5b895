#include "preprocessor/program/cad_list.hpp"

#include "format/io/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::prep {

namespace {

// Rounding beside `size` is shown as zero.
std::string text(const Point3& p, double size) {
  const auto tidy = [&](double x) { return std::abs(x) < 1e-9 * size ? 0.0 : x; };
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", tidy(p[0]), tidy(p[1]), tidy(p[2]));
}

bool is_zero(const Point3& p) {
  return p == Point3{};
}

// "normal (0, 0, 1)", "radius 4, axis (0, 0, 1) through (10, 0, 0)".
std::string shape_of(const CadFace& face, double size) {
  if (face.kind == "plane") return "normal " + text(face.direction, 1);
  std::string words;
  if (face.radius > 0) words = fmt::format("radius {:.6g}", face.radius);
  if (!is_zero(face.direction))
    words += fmt::format("{}axis {} through {}", words.empty() ? "" : ", ", text(face.direction, 1),
                         text(face.axis_point, size));
  else if (face.kind == "sphere")
    words += ", centre " + text(face.axis_point, size);
  return words;
}

template <class Items> int width_of(const Items& items) {
  std::size_t width = 4;
  for (const auto& item : items) width = std::max(width, item.name.size());
  return static_cast<int>(width);
}

io::JsonObject json_of(const CadFace& face) {
  io::JsonObject out;
  out.add("name", face.name).add("type", face.kind).add("area", face.area).add("centroid", face.centroid);
  if (face.kind == "plane")
    out.add("normal", face.direction);
  else if (!is_zero(face.direction))
    out.add("axis", face.direction).add("axis_point", face.axis_point);
  else if (face.kind == "sphere")
    out.add("centre", face.axis_point);
  if (face.radius > 0) out.add("radius", face.radius);
  if (!face.colour.empty()) out.add("colour", face.colour);
  return out;
}

io::JsonObject json_of(const CadEdge& edge) {
  io::JsonObject out;
  out.add("name", edge.name).add("type", edge.kind).add("length", edge.length);
  out.add("middle", edge.middle).add("faces", edge.faces);
  if (edge.radius > 0) out.add("radius", edge.radius);
  return out;
}

io::JsonObject json_of(const CadVertex& vertex) {
  return io::JsonObject().add("name", vertex.name).add("position", vertex.position);
}

io::JsonObject json_of(const CadPlace& place) {
  return io::JsonObject().add("name", place.name).add("rotation", place.rotation).add("shift", place.shift);
}

template <class Items> std::vector<io::JsonObject> json_list(const Items& items) {
  std::vector<io::JsonObject> out;
  for (const auto& item : items) out.push_back(json_of(item));
  return out;
}

} // namespace

std::string cad_list_text(const CadModel& cad, const std::string& file, bool edges) {
  const std::string unit = cad.length_unit == "unspecified" ? "" : cad.length_unit;
  std::string out = fmt::format("{}: {}, {}, {} {}\n", file, cad.format,
                                unit.empty() ? "length unit unspecified" : "lengths in " + unit, cad.solids.size(),
                                cad.solids.size() == 1 ? "solid" : "solids");
  for (const CadSolid& solid : cad.solids) {
    const double size = std::sqrt(solid.area);
    out += fmt::format("\nsolid \"{}\"{}: volume {:.8g}, area {:.8g}, centroid {}{}\n", solid.name,
                       solid.colour.empty() ? "" : " " + solid.colour, solid.volume, solid.area,
                       text(solid.centroid, size),
                       solid.places.size() > 1 ? fmt::format(", at {} places", solid.places.size()) : "");
    const int width = width_of(solid.faces);
    out += fmt::format("  {:<{}}  {:<9} {:>13}  {:<7}  {:<34} {}\n", "face", width, "type", "area", "colour",
                       "centroid", "shape");
    for (const CadFace& face : solid.faces)
      out += fmt::format("  {:<{}}  {:<9} {:>13.8g}  {:<7}  {:<34} {}\n", face.name, width, face.kind, face.area,
                         face.colour, text(face.centroid, size), shape_of(face, size));
    if (!edges) continue;
    const int edge_width = width_of(solid.edges);
    out += fmt::format("  {:<{}}  {:<9} {:>13}  {:<34} faces\n", "edge", edge_width, "type", "length", "middle");
    for (const CadEdge& edge : solid.edges)
      out += fmt::format("  {:<{}}  {:<9} {:>13.8g}  {:<34} {}{}\n", edge.name, edge_width, edge.kind, edge.length,
                         text(edge.middle, size),
                         edge.faces.size() == 1 ? edge.faces[0] + ", seam"
                                                : fmt::format("{}", fmt::join(edge.faces, " | ")),
                         edge.radius > 0 ? fmt::format(", radius {:.6g}", edge.radius) : "");
    const int vertex_width = width_of(solid.vertices);
    out += fmt::format("  {:<{}}  position\n", "vertex", vertex_width);
    for (const CadVertex& vertex : solid.vertices)
      out += fmt::format("  {:<{}}  {}\n", vertex.name, vertex_width, text(vertex.position, size));
  }
  for (const std::string& finding : cad.findings) out += fmt::format("found       {}\n", finding);
  return out;
}

std::string cad_list_json(const CadModel& cad, const std::string& file, bool edges) {
  std::vector<io::JsonObject> solids;
  for (const CadSolid& solid : cad.solids) {
    io::JsonObject out;
    out.add("name", solid.name).add("volume", solid.volume).add("area", solid.area).add("centroid", solid.centroid);
    if (!solid.colour.empty()) out.add("colour", solid.colour);
    out.add("places", json_list(solid.places)).add("faces", json_list(solid.faces));
    if (edges) out.add("edges", json_list(solid.edges)).add("vertices", json_list(solid.vertices));
    solids.push_back(std::move(out));
  }
  io::JsonObject json;
  json.add("input", file).add("format", cad.format).add("length_unit", cad.length_unit);
  json.add("file_unit", cad.file_unit).add("solids", solids);
  json.add("findings", cad.findings).add("warnings", cad.warnings);
  return json.text();
}

} // namespace iga::prep
