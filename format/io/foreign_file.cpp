#include "format/io/foreign_file.hpp"

#include "format/io/stl_reader.hpp"
#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <zlib.h>

namespace iga::io {

namespace {

using namespace std::string_view_literals;

/// What to do with a kind of file.
enum class Kind { Cad, Mesh, Drawing, Archive, Model, Picture, Text };

std::string advice(Kind kind) {
  switch (kind) {
  case Kind::Cad:
    return "export the part as STL from the CAD program (binary, units and deviation as fine as needed)";
  case Kind::Mesh:
    return "convert its surface to STL, OBJ, PLY or OFF";
  case Kind::Drawing:
    return "open it in the CAD program and export the solid as STL";
  case Kind::Archive:
    return "unpack it first and give the STL, OBJ, PLY or OFF file";
  case Kind::Model:
    return "give a model to igasolve; igaprep makes one from an STL, OBJ, PLY or OFF file";
  default:
    return "give an STL, OBJ, PLY or OFF file";
  }
}

struct Signature {
  std::string_view start; ///< the file's first bytes
  std::string_view name;
  Kind kind;
};

/// First bytes as the formats' specifications give them.
constexpr std::array signatures{
    Signature{"ISO-10303-", step_file, Kind::Cad},
    Signature{"DBRep_DrawableShape", brep_file, Kind::Cad},
    Signature{"CASCADE Topology", brep_file, Kind::Cad},
    Signature{"Open CASCADE Topology", brep_file, Kind::Cad},
    Signature{"**ABCDEFGHIJKLMNOPQRSTUVWXYZ", "a Parasolid file (x_t)", Kind::Cad},
    Signature{"PS\0"sv, "a Parasolid file (x_b)", Kind::Cad},
    Signature{"ACIS BinaryFile", "an ACIS file (SAB)", Kind::Cad},
    Signature{"ASM BinaryFile", "an ACIS file (SAB)", Kind::Cad},
    Signature{"V5_CFV2", "a CATIA V5 file", Kind::Cad},
    Signature{"#UGC:2", "a Creo (Pro/ENGINEER) part", Kind::Cad},
    Signature{"3D Geometry File Format", "a Rhino file (3dm)", Kind::Cad},
    Signature{"AutoCAD Binary DXF", "a DXF drawing", Kind::Drawing},
    Signature{"AC10", "a DWG drawing", Kind::Drawing},
    Signature{"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1",
              "a document of a CAD or office program (OLE container: SolidWorks, "
              "Inventor, Solid Edge, …)",
              Kind::Cad},
    Signature{"glTF", "a glTF scene (glb)", Kind::Mesh},
    Signature{"Kaydara FBX Binary", "an FBX scene", Kind::Mesh},
    Signature{"BLENDER", "a Blender scene", Kind::Mesh},
    Signature{"PXR-USDC", "a USD scene", Kind::Mesh},
    Signature{"#usda", "a USD scene", Kind::Mesh},
    Signature{"#VRML", "a VRML scene", Kind::Mesh},
    Signature{"#X3D", "an X3D scene", Kind::Mesh},
    Signature{"$MeshFormat", "a Gmsh mesh", Kind::Mesh},
    Signature{"# vtk DataFile", "a VTK file", Kind::Mesh},
    Signature{"*HEADING", "an Abaqus or CalculiX input file", Kind::Mesh},
    Signature{"*Heading", "an Abaqus or CalculiX input file", Kind::Mesh},
    Signature{"\x89HDF\r\n\x1a\n", "an HDF5 file, perhaps a model already", Kind::Model},
    Signature{"7z\xBC\xAF\x27\x1C", "a 7-Zip archive", Kind::Archive},
    Signature{"Rar!\x1A\x07", "a RAR archive", Kind::Archive},
    Signature{"\xFD"
              "7zXZ\0"sv,
              "an xz archive", Kind::Archive},
    Signature{"BZh", "a bzip2 archive", Kind::Archive},
    Signature{"\x28\xB5\x2F\xFD", "a zstd archive", Kind::Archive},
    Signature{"%PDF", "a PDF document", Kind::Picture},
    Signature{"\x89PNG", "a picture (PNG)", Kind::Picture},
    Signature{"\xFF\xD8\xFF", "a picture (JPEG)", Kind::Picture},
    Signature{"GIF8", "a picture (GIF)", Kind::Picture},
    Signature{"\xFF\xFE", "text in UTF-16", Kind::Text},
    Signature{"\xFE\xFF", "text in UTF-16", Kind::Text},
};

struct Ending {
  std::string_view ending; ///< lower case, with its dot
  std::string_view name;
  Kind kind;
};

constexpr std::array endings{
    Ending{".step", step_file, Kind::Cad},
    Ending{".stp", step_file, Kind::Cad},
    Ending{".stpz", "a compressed STEP file", Kind::Cad},
    Ending{".stp.gz", "a compressed STEP file", Kind::Cad},
    Ending{".step.gz", "a compressed STEP file", Kind::Cad},
    Ending{".p21", step_file, Kind::Cad},
    Ending{".iges", iges_file, Kind::Cad},
    Ending{".igs", iges_file, Kind::Cad},
    Ending{".brep", brep_file, Kind::Cad},
    Ending{".brp", brep_file, Kind::Cad},
    Ending{".x_t", "a Parasolid file", Kind::Cad},
    Ending{".x_b", "a Parasolid file", Kind::Cad},
    Ending{".xmt_txt", "a Parasolid file", Kind::Cad},
    Ending{".xmt_bin", "a Parasolid file", Kind::Cad},
    Ending{".sat", "an ACIS file", Kind::Cad},
    Ending{".sab", "an ACIS file", Kind::Cad},
    Ending{".jt", "a JT file", Kind::Cad},
    Ending{".sldprt", "a SolidWorks part", Kind::Cad},
    Ending{".sldasm", "a SolidWorks assembly", Kind::Cad},
    Ending{".slddrw", "a SolidWorks drawing", Kind::Drawing},
    Ending{".catpart", "a CATIA part", Kind::Cad},
    Ending{".catproduct", "a CATIA assembly", Kind::Cad},
    Ending{".cgr", "a CATIA graphics file", Kind::Cad},
    Ending{".3dxml", "a 3DXML file", Kind::Cad},
    Ending{".ipt", "an Inventor part", Kind::Cad},
    Ending{".iam", "an Inventor assembly", Kind::Cad},
    Ending{".par", "a Solid Edge part", Kind::Cad},
    Ending{".psm", "a Solid Edge part", Kind::Cad},
    Ending{".prt", "an NX or Creo part", Kind::Cad},
    Ending{".asm", "an NX or Creo assembly", Kind::Cad},
    Ending{".f3d", "a Fusion 360 design", Kind::Cad},
    Ending{".fcstd", "a FreeCAD document", Kind::Cad},
    Ending{".3dm", "a Rhino file (3dm)", Kind::Cad},
    Ending{".skp", "a SketchUp file", Kind::Cad},
    Ending{".ifc", "an IFC file", Kind::Cad},
    Ending{".scad", "an OpenSCAD script", Kind::Cad},
    Ending{".dwg", "a DWG drawing", Kind::Drawing},
    Ending{".dxf", "a DXF drawing", Kind::Drawing},
    Ending{".3mf", "a 3MF file", Kind::Mesh},
    Ending{".amf", "an AMF file", Kind::Mesh},
    Ending{".gltf", "a glTF scene", Kind::Mesh},
    Ending{".glb", "a glTF scene", Kind::Mesh},
    Ending{".fbx", "an FBX scene", Kind::Mesh},
    Ending{".3ds", "a 3DS scene", Kind::Mesh},
    Ending{".blend", "a Blender scene", Kind::Mesh},
    Ending{".dae", "a COLLADA scene", Kind::Mesh},
    Ending{".wrl", "a VRML scene", Kind::Mesh},
    Ending{".x3d", "an X3D scene", Kind::Mesh},
    Ending{".usd", "a USD scene", Kind::Mesh},
    Ending{".usdz", "a USD scene", Kind::Mesh},
    Ending{".msh", "a Gmsh or Fluent mesh", Kind::Mesh},
    Ending{".inp", "an Abaqus or CalculiX input file", Kind::Mesh},
    Ending{".bdf", "a Nastran input file", Kind::Mesh},
    Ending{".nas", "a Nastran input file", Kind::Mesh},
    Ending{".vtk", "a VTK file", Kind::Mesh},
    Ending{".vtp", "a VTK file", Kind::Mesh},
    Ending{".vtu", "a VTK file", Kind::Mesh},
    Ending{".gcode", "G-code for a machine", Kind::Text},
    Ending{".zip", "a ZIP archive", Kind::Archive},
    Ending{".gz", "a gzip archive", Kind::Archive},
    Ending{".h5", "an HDF5 file, perhaps a model already", Kind::Model},
    Ending{".toml", "a settings file", Kind::Text},
};

ForeignFile foreign(std::string_view name, Kind kind) {
  return {std::string(name), advice(kind)};
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// The lines of an IGES file have 80 columns; the letter of the section stands in the 73rd: S in the first line.
bool looks_like_iges(std::string_view bytes) {
  return bytes.size() > 80 && bytes[72] == 'S' &&
         bytes.substr(73, 7).find_first_not_of(" 01") == std::string_view::npos &&
         bytes.substr(73, 7).find('1') != std::string_view::npos;
}

/// Pairs of lines, a code and its value: "0", "SECTION" comes first, but for comments (999).
bool looks_like_dxf(std::string_view bytes) {
  TextLines lines(bytes.substr(0, 4096));
  std::string_view code, value;
  while (lines.next(code) && lines.next(value)) {
    const std::string_view word = TextTokens(code).next();
    if (word != "999") return word == "0" && TextTokens(value).next() == "SECTION";
  }
  return false;
}

/// Formats that are XML, JSON or other text.
std::optional<ForeignFile> recognise_text(std::string_view bytes) {
  const std::string head = lower(bytes.substr(0, 2048));
  const std::size_t first = std::min(head.find_first_not_of(" \t\r\n"), head.size());
  const std::string_view text = std::string_view(head).substr(first);
  if (text.starts_with("version https://git-lfs"))
    return ForeignFile{"a Git LFS pointer, which stands for a file that was not downloaded", "run \"git lfs pull\""};
  if (text.starts_with("<")) {
    for (const auto& [tag, name, kind] :
         {std::tuple{"<!doctype html", "a web page (HTML), not the file that was to be downloaded", Kind::Text},
          std::tuple{"<html", "a web page (HTML), not the file that was to be downloaded", Kind::Text},
          std::tuple{"<amf", "an AMF file", Kind::Mesh}, std::tuple{"<collada", "a COLLADA scene", Kind::Mesh},
          std::tuple{"<x3d", "an X3D scene", Kind::Mesh}, std::tuple{"<vtkfile", "a VTK file", Kind::Mesh},
          std::tuple{"<svg", "a picture (SVG)", Kind::Picture},
          std::tuple{"<model", "the inside of a 3MF file", Kind::Mesh}})
      if (text.find(tag) != std::string_view::npos) return foreign(name, kind);
    return foreign("an XML file", Kind::Text);
  }
  if (text.starts_with("{"))
    return text.find("\"asset\"") != std::string_view::npos ? foreign("a glTF scene", Kind::Mesh)
                                                            : foreign("a JSON file", Kind::Text);
  if (text.starts_with("iso-10303-")) return foreign(step_file, Kind::Cad);
  if (text.starts_with("version ") && text.substr(0, 80).find(" jt") != std::string_view::npos)
    return foreign("a JT file", Kind::Cad);
  return std::nullopt;
}

/// The first bytes inside a gzip archive; empty where it cannot be unpacked.
std::string start_of_gzip(std::string_view bytes) {
  z_stream stream{};
  constexpr int gzip_window = 15 + 16;
  if (inflateInit2(&stream, gzip_window) != Z_OK) return {};
  std::string out(4096, '\0');
  std::string in(bytes.substr(0, 8192)); // zlib takes no constant bytes
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  inflate(&stream, Z_SYNC_FLUSH);
  out.resize(out.size() - stream.avail_out);
  inflateEnd(&stream);
  return out;
}

std::optional<ForeignFile> recognise_archive(std::string_view bytes) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06")) {
    // Names of the members stand in clear text.
    for (const auto& [member, name, kind] :
         {std::tuple{"3D/3dmodel.model", "a 3MF file", Kind::Mesh},
          std::tuple{"Document.xml", "a FreeCAD document", Kind::Cad}, std::tuple{".3dxml", "a 3DXML file", Kind::Cad},
          std::tuple{".stp", "a compressed STEP file", Kind::Cad},
          std::tuple{".step", "a compressed STEP file", Kind::Cad}, std::tuple{".usdc", "a USD scene", Kind::Mesh}})
      if (bytes.find(member) != std::string_view::npos) return foreign(name, kind);
    return foreign("a ZIP archive", Kind::Archive);
  }
  if (!bytes.starts_with("\x1F\x8B")) return std::nullopt;
  const std::string inside = start_of_gzip(bytes);
  if (!inside.starts_with("\x1F\x8B"))
    if (const auto known = recognise_content(inside))
      return ForeignFile{known->name + ", compressed by gzip", known->advice};
  return foreign("a gzip archive", Kind::Archive);
}

} // namespace

std::optional<ForeignFile> recognise_content(std::string_view bytes) {
  if (const auto archive = recognise_archive(bytes)) return archive;
  for (const Signature& s : signatures)
    if (bytes.starts_with(s.start)) return foreign(s.name, s.kind);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  if (looks_like_iges(bytes)) return foreign(iges_file, Kind::Cad);
  if (looks_like_dxf(bytes)) return foreign("a DXF drawing", Kind::Drawing);
  return recognise_text(bytes);
}

std::optional<ForeignFile> recognise_name(const std::filesystem::path& file) {
  std::string name = lower(file.filename().string());
  // Creo counts its versions: part.prt.12
  const auto digits = name.find_last_not_of("0123456789");
  if (digits != std::string::npos && digits + 1 < name.size() && name[digits] == '.') name.resize(digits);
  const Ending* best = nullptr;
  for (const Ending& e : endings)
    if (name.ends_with(e.ending) && (!best || e.ending.size() > best->ending.size())) best = &e;
  return best ? std::optional(foreign(best->name, best->kind)) : std::nullopt;
}

void refuse_foreign(std::string_view bytes, const std::filesystem::path& file) {
  if (looks_like_ascii_stl(bytes) || is_whole_binary_stl(bytes)) return;
  const auto by_content = recognise_content(bytes);
  const auto known = by_content ? by_content : recognise_name(file);
  if (!known) return;
  throw InputError(fmt::format("{}: this is {}{}, no STL, OBJ, PLY or OFF file; {}", file.string(),
                               by_content ? "" : "by its name ", known->name, known->advice));
}

} // namespace iga::io
