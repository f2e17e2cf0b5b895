// Files of other formats are called by their own name, by content first.
#include "format/io/foreign_file.hpp"

#include "format/model/errors.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

namespace iga::io {
namespace {

using namespace std::string_literals;

std::string gzipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string in = text, out(text.size() + 100, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

std::string iges_line(const std::string& text) {
  std::string line = text;
  line.resize(72, ' ');
  return line + "S      1\n";
}

TEST(ForeignFile, IsToldByItsContent) {
  const std::string step = "ISO-10303-21;\nHEADER;\n";
  for (const auto& [bytes, name] : {
           std::pair{step, "a STEP file"s},
           {"\xEF\xBB\xBF \n" + step, "a STEP file"},
           {gzipped(step), "a STEP file, compressed by gzip"},
           {gzipped("solid"), "a gzip archive"},
           {iges_line("a part") + iges_line(""), "an IGES file"},
           {"PK\x03\x04\x14\0\0\0xx3D/3dmodel.model"s, "a 3MF file"},
           {"PK\x03\x04\x14\0\0\0xxDocument.xml"s, "a FreeCAD document"},
           {"PK\x03\x04\x14\0\0\0xxpart.stl"s, "a ZIP archive"},
           {"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n", "an OpenCASCADE BREP file"},
           {"**ABCDEFGHIJKLMNOPQRSTUVWXYZ****\n", "a Parasolid file (x_t)"},
           {"Version 9.5 JT  DM 6.4.2.3\n", "a JT file"},
           {"3D Geometry File Format       70", "a Rhino file (3dm)"},
           {"AC1032\0\0"s, "a DWG drawing"},
           {"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", "a DXF drawing"},
           {"999\nmade by hand\n0\nSECTION\n", "a DXF drawing"},
           {"V5_CFV2\0\0"s, "a CATIA V5 file"},
           {"glTF\2\0\0\0"s, "a glTF scene (glb)"},
           {"{ \"asset\" : { \"version\" : \"2.0\" } }", "a glTF scene"},
           {"\n<!DOCTYPE html>\n<html>", "a web page (HTML), not the file that was to be downloaded"},
           {"<?xml version=\"1.0\"?>\n<amf unit=\"millimeter\">", "an AMF file"},
           {"version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
            "a Git LFS pointer, which stands for a file that was not downloaded"},
           {"\x89HDF\r\n\x1a\n\0\0"s, "an HDF5 file, perhaps a model already"},
       }) {
    const auto found = recognise_content(bytes);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->name, name);
    EXPECT_FALSE(found->advice.empty());
  }
  for (const char* mesh : {"", "v 0 0 0\n", "# made by hand\n", "0 0 0\n", "solid a\n"})
    EXPECT_FALSE(recognise_content(mesh)) << mesh;
}

TEST(ForeignFile, IsToldByItsName) {
  for (const auto& [file, name] : {std::pair{"a/Part.SLDPRT", "a SolidWorks part"},
                                   {"a.CATPart", "a CATIA part"},
                                   {"a.x_b", "a Parasolid file"},
                                   {"bracket.prt.12", "an NX or Creo part"},
                                   {"a.stp.gz", "a compressed STEP file"},
                                   {"a.3mf", "a 3MF file"}}) {
    const auto found = recognise_name(file);
    ASSERT_TRUE(found) << file;
    EXPECT_EQ(found->name, name);
  }
  for (const char* file : {"a.stl", "a", "step", "a.obj", "a.v2.stl"}) EXPECT_FALSE(recognise_name(file)) << file;
}

TEST(ForeignFile, IsRefusedWithWhatToDoUnlessItIsAWholeStl) {
  try {
    refuse_foreign("ISO-10303-21;\n", "part.stl");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              "part.stl: this is a STEP file, no STL, OBJ, PLY or OFF file; export the part as STL from the "
              "CAD program (binary, units and deviation as fine as needed)"s);
  }
  EXPECT_THROW(refuse_foreign("what is it", "part.ipt"), InputError);
  std::string binary = "glTF";
  binary.resize(84, '\0');
  refuse_foreign(binary, "part.ipt"); // no facets, but whole
  refuse_foreign("solid a\nfacet", "part.ipt");
}

} // namespace
} // namespace iga::io
