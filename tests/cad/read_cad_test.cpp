// CAD files → facets: exact volumes, closed surfaces, second order, names, units, places, damaged files.
#include "format/model/errors.hpp"
#include "preprocessor/cad/cad_archive.hpp"
#include "preprocessor/cad/occt/read_cad.hpp"
#include "preprocessor/surface/prepare_surface.hpp"
#include "tests/cad/cad_parts.hpp"
#include "tests/support/temp_folder.hpp"

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <sstream>

namespace iga::test {

namespace {

using prep::CadModel;
using prep::CadOptions;
using prep::CadSolid;

constexpr double pi = std::numbers::pi;

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// What the surface preparation makes of the facets: nothing to repair.
prep::PreparedSurface prepared(const CadSolid& solid) {
  prep::ReadMesh read;
  read.mesh = solid.mesh;
  read.file = solid.name;
  read.format = "STEP";
  return prep::prepare_surface(std::move(read), {});
}

class CadTest : public testing::Test {
 protected:
  CadModel read(const CadOptions& options = {}) const { return prep::read_cad(file_, options); }
  CadModel read(double chord) const {
    CadOptions options;
    options.chord = chord;
    return read(options);
  }
  std::string refusal(const CadOptions& options = {}) const {
    try {
      read(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void damage(const std::string& from, const std::string& to) const {
    std::stringstream bytes;
    bytes << std::ifstream(file_).rdbuf();
    std::string text = bytes.str();
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, from.size(), to);
    std::ofstream(file_) << text;
  }

  TempFolder folder_;
  std::filesystem::path file_ = folder_.path() / "part.step";
};

class CadPart : public CadTest, public testing::WithParamInterface<std::string> {};

// Facets of a chord c change the volume by less than area · c, and a quarter of the chord leaves about a quarter of the
// error: the chord is of second order in the size of the facets.
TEST_P(CadPart, ClosedAndOfSecondOrder) {
  write_step(make_cad_part(GetParam()), file_);
  std::vector<double> errors;
  for (const double chord : {0.04, 0.01, 0.0025}) {
    const CadModel model = read(chord);
    ASSERT_EQ(model.solids.size(), 1U);
    const CadSolid& solid = model.solids.front();
    EXPECT_LE(solid.deviation, 1.01 * chord);
    const prep::PreparedSurface surface = prepared(solid);
    EXPECT_TRUE(surface.findings.empty()) << surface.findings.front();
    const VolumeMoments moments = volume_moments(surface.mesh);
    errors.push_back(std::abs(moments.volume - solid.volume));
    EXPECT_LT(errors.back(), solid.area * chord + 1e-6 * solid.volume);
    EXPECT_LT(distance(moments.centroid, solid.centroid), chord + 1e-5);
    EXPECT_NEAR(surface_area(surface.mesh), solid.area, (1e-6 + 0.5 * chord) * solid.area);
    double faces = 0;
    for (const prep::CadFace& face : solid.faces) faces += face.area;
    EXPECT_NEAR(faces, solid.area, 1e-6 * solid.area);
    EXPECT_EQ(solid.mesh.region_names.size(), solid.faces.size());
  }
  const double rounding = 2e-6 * read(0.04).solids.front().volume; // of OpenCASCADE's integration
  if (errors[0] > 10 * rounding) {
    EXPECT_LT(errors[2], errors[0] / 5 + rounding);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CadPart, testing::ValuesIn(cad_part_names()),
                         [](const auto& part) { return part.param; });

TEST_F(CadTest, KnowsTheExactVolume) {
  write_step(make_cad_part("torus"), file_);
  const CadSolid torus = read(0.01).solids.front();
  EXPECT_NEAR(torus.volume, 2 * pi * pi * 10 * 16, 1e-6 * torus.volume);
  EXPECT_NEAR(torus.area, 4 * pi * pi * 10 * 4, 1e-6 * torus.area);
  ASSERT_EQ(torus.faces.size(), 1U);
  EXPECT_EQ(torus.faces[0].kind, "torus");
  EXPECT_NEAR(torus.faces[0].radius, 10, 1e-12);
}

TEST_F(CadTest, DescribesFaces) {
  write_step(make_cad_part("crossing_bores"), file_);
  const CadSolid solid = read(0.01).solids.front();
  const auto bore = [&](double radius) {
    return std::find_if(solid.faces.begin(), solid.faces.end(),
                        [&](const auto& f) { return f.kind == "bore" && std::abs(f.radius - radius) < 1e-9; });
  };
  ASSERT_NE(bore(5), solid.faces.end());
  EXPECT_NEAR(std::abs(bore(5)->direction[0]), 1, 1e-12);
  ASSERT_NE(bore(3), solid.faces.end());
  EXPECT_NEAR(std::abs(bore(3)->direction[2]), 1, 1e-12);
  for (const prep::CadFace& face : solid.faces) {
    if (face.kind != "plane") continue;
    const Point3 out{face.centroid[0], face.centroid[1], face.centroid[2]}; // the block is centred
    EXPECT_GT(out[0] * face.direction[0] + out[1] * face.direction[1] + out[2] * face.direction[2], 0) << face.name;
  }
}

TEST_F(CadTest, KeepsEdgesOnTheFacets) {
  write_step(make_cad_part("cone"), file_);
  const CadSolid cone = read(0.001).solids.front();
  double longest = 0;
  for (const prep::CadEdge& edge : cone.edges) {
    double length = 0;
    for (std::size_t k = 1; k < edge.points.size(); ++k) {
      length += distance(edge.points[k - 1], edge.points[k]);
      EXPECT_NE(std::find(cone.mesh.vertices.begin(), cone.mesh.vertices.end(), edge.points[k]),
                cone.mesh.vertices.end());
    }
    EXPECT_NEAR(length, edge.length, 1e-3 * edge.length) << edge.name;
    longest = std::max(longest, edge.length);
    if (edge.kind == "circle") {
      EXPECT_EQ(edge.points.front(), edge.points.back());
    }
  }
  EXPECT_NEAR(longest, 2 * pi * 10, 1e-6);
  EXPECT_EQ(cone.vertices.size(), 2U);
}

TEST_F(CadTest, KeepsNamesAndColours) {
  write_named_box(file_);
  const CadSolid box = read().solids.front();
  EXPECT_EQ(box.name, "named box");
  std::vector<std::string> names;
  for (const prep::CadFace& face : box.faces) {
    names.push_back(face.name);
    if (face.name != "top") continue;
    EXPECT_EQ(face.colour, "#FF0000");
    EXPECT_NEAR(face.centroid[2], 10, 1e-9);
  }
  EXPECT_EQ(std::count(names.begin(), names.end(), "top"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "bottom"), 1);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST_F(CadTest, TakesTheUnitOfTheFile) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(25.4, 50.8, 76.2).Shape();
  write_step(box, file_, "INCH");
  EXPECT_EQ(read().length_unit, "in");
  EXPECT_NEAR(read().solids.front().volume, 6, 1e-9);
  CadOptions options;
  options.length_unit = "mm";
  EXPECT_NEAR(read(options).solids.front().volume, 25.4 * 50.8 * 76.2, 1e-6);
  options.scale = 2;
  EXPECT_NEAR(read(options).solids.front().volume, 8 * 25.4 * 50.8 * 76.2, 1e-5);
  write_step(box, file_, "M");
  EXPECT_EQ(read().length_unit, "m");
  EXPECT_NEAR(read().solids.front().volume, 0.0254 * 0.0508 * 0.0762, 1e-12);
  EXPECT_NEAR(volume_moments(read().solids.front().mesh).volume, 0.0254 * 0.0508 * 0.0762, 1e-15);
  options.length_unit = "parsec";
  EXPECT_NE(refusal(options).find("expected one of mm, cm, m, um, in, ft"), std::string::npos);
}

TEST_F(CadTest, ReadsIgesAndBrep) {
  for (const char* ending : {"iges", "brep"}) {
    file_ = folder_.path() / ("part." + std::string(ending));
    const TopoDS_Shape part = make_cad_part("crossing_bores");
    if (file_.extension() == ".iges")
      write_iges(part, file_);
    else
      write_brep(part, file_);
    const CadModel model = read(0.01);
    EXPECT_EQ(model.length_unit, file_.extension() == ".iges" ? "mm" : "unspecified");
    ASSERT_EQ(model.solids.size(), 1U);
    write_step(part, folder_.path() / "same.step");
    CadOptions options;
    EXPECT_NEAR(model.solids[0].volume, prep::read_cad(folder_.path() / "same.step", options).solids[0].volume, 1e-3);
    EXPECT_TRUE(prepared(model.solids[0]).findings.empty());
  }
}

TEST_F(CadTest, PlacesRepeatedSolids) {
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(30, 20, 2).Shape();
  const TopoDS_Shape bolt = BRepPrimAPI_MakeCylinder(2, 10).Shape();
  write_assembly({{"plate", plate, {0, 0, 5}}, {"bolt left", bolt, {5, 10, 7}}, {"bolt right", bolt, {25, 10, 7}, 90}},
                 file_);
  const CadModel model = read(0.01);
  ASSERT_EQ(model.solids.size(), 2U);
  // What stands once is taken where it stands.
  EXPECT_EQ(model.solids[0].name, "plate");
  EXPECT_NEAR(model.solids[0].centroid[2], 6, 1e-9);
  ASSERT_EQ(model.solids[0].places.size(), 1U);
  EXPECT_EQ(model.solids[0].places[0].shift, Point3{});
  ASSERT_EQ(model.solids[1].places.size(), 2U);
  EXPECT_EQ(model.solids[1].places[0].name, "bolt left");
  EXPECT_EQ(model.solids[1].places[1].name, "bolt right");
  EXPECT_NEAR(model.solids[1].places[1].shift[0], 25, 1e-9);
  EXPECT_NEAR(model.solids[1].places[1].rotation[1][0], 1, 1e-12);
  EXPECT_NEAR(model.solids[1].centroid[2], 5, 1e-6);
}

TEST_F(CadTest, TellsOverlaps) {
  write_assembly(
      {{"a", BRepPrimAPI_MakeBox(10, 10, 10).Shape()}, {"b", BRepPrimAPI_MakeBox(10, 8, 6).Shape(), {9.5, 1, 2}}},
      file_);
  CadOptions options;
  options.overlaps = true;
  const CadModel model = read(options);
  ASSERT_EQ(model.overlaps.size(), 1U);
  EXPECT_NEAR(model.overlaps[0].volume, 0.5 * 8 * 6, 1e-6);
  EXPECT_EQ(model.overlaps[0].first, "a");
  write_assembly(
      {{"a", BRepPrimAPI_MakeBox(10, 10, 10).Shape()}, {"b", BRepPrimAPI_MakeBox(10, 8, 6).Shape(), {10, 1, 2}}},
      file_);
  EXPECT_TRUE(read(options).overlaps.empty());
}

TEST_F(CadTest, UnitesSolidsThatTouch) {
  write_assembly(
      {{"a", BRepPrimAPI_MakeBox(10, 10, 10).Shape()}, {"b", BRepPrimAPI_MakeCylinder(4, 6).Shape(), {5, 5, 10}}},
      file_);
  CadOptions options;
  options.merge = true;
  options.chord = 0.01;
  const CadModel model = read(options);
  ASSERT_EQ(model.solids.size(), 1U);
  EXPECT_NEAR(model.solids[0].volume, 1000 + pi * 16 * 6, 1e-3);
  const prep::PreparedSurface surface = prepared(model.solids[0]);
  EXPECT_EQ(surface.bodies, 1);
  EXPECT_TRUE(surface.findings.empty());
  write_assembly(
      {{"a", BRepPrimAPI_MakeBox(10, 10, 10).Shape()}, {"b", BRepPrimAPI_MakeBox(1, 1, 1).Shape(), {20, 0, 0}}}, file_);
  EXPECT_NE(refusal(options).find("not all of them touch"), std::string::npos);
}

TEST_F(CadTest, SurfacesWithoutASolid) {
  BRep_Builder builder;
  TopoDS_Compound faces;
  builder.MakeCompound(faces);
  for (TopExp_Explorer it(BRepPrimAPI_MakeBox(30, 20, 10).Shape(), TopAbs_FACE); it.More(); it.Next())
    builder.Add(faces, it.Current());
  write_step(faces, file_);
  EXPECT_NE(refusal().find("6 faces and no solid"), std::string::npos);
  EXPECT_NE(refusal().find("--sew"), std::string::npos);
  CadOptions options;
  options.sew = 1e-3;
  const CadModel model = read(options);
  ASSERT_EQ(model.solids.size(), 1U);
  EXPECT_NEAR(model.solids[0].volume, 6000, 1e-6);
  EXPECT_TRUE(prepared(model.solids[0]).findings.empty());
  EXPECT_FALSE(model.findings.empty());
  // Five faces close nothing.
  TopoDS_Compound open;
  builder.MakeCompound(open);
  int count = 0;
  for (TopExp_Explorer it(BRepPrimAPI_MakeBox(30, 20, 10).Shape(), TopAbs_FACE); it.More() && count < 5;
       it.Next(), ++count)
    builder.Add(open, it.Current());
  write_step(open, file_);
  EXPECT_NE(refusal(options).find("4 edges stay open"), std::string::npos) << refusal(options);
}

TEST_F(CadTest, RefusesDamagedFiles) {
  std::ofstream(file_) << "ISO-10303-21;\nHEADER;\n";
  EXPECT_NE(refusal().find("part.step: the STEP file cannot be read"), std::string::npos) << refusal();
  std::ofstream(file_) << "solid not a STEP file\n";
  EXPECT_NE(refusal().find("cannot be read"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("Line "), std::string::npos) << refusal();
  // An assembly of nothing.
  write_step(make_cad_part("box"), file_);
  damage("MANIFOLD_SOLID_BREP", "SHELL_BASED_NONSENSE");
  EXPECT_NE(refusal(), "");
  // A face whose plane is missing would be a hole.
  write_step(make_cad_part("box"), file_);
  damage("PLANE(", "PLAIN(");
  EXPECT_NE(refusal().find("1 of 6 faces"), std::string::npos) << refusal();
}

TEST(CadArchive, KeepsEverything) {
  TempFolder folder;
  write_named_box(folder.path() / "box.step");
  prep::CadAnswer answer;
  answer.model = prep::read_cad(folder.path() / "box.step", {});
  const std::string bytes = to_bytes(answer);
  EXPECT_EQ(to_bytes(prep::answer_of(bytes)), bytes);
  EXPECT_THROW(prep::answer_of(std::string_view(bytes).substr(0, bytes.size() - 1)), std::runtime_error);
}

} // namespace

} // namespace iga::test
