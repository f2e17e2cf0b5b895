// Readers: what is accepted, to the last bit, and how each kind of bad file is refused.
#include "preprocessor/surface/read_mesh.hpp"

#include "format/io/sha256.hpp"
#include "format/model/errors.hpp"
#include "tests/surface/shapes.hpp"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

namespace iga::prep {
namespace {

class ReadMeshTest : public ::testing::Test {
 protected:
  ReadMeshTest() {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("iga_read_{}_{}", getpid(), ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  ~ReadMeshTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string refusal(const std::filesystem::path& file) const {
    try {
      read_mesh(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }
  void expect_refused(const std::filesystem::path& file, const std::string& words) const {
    const std::string text = refusal(file);
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_NE(text.find(file.string()), std::string::npos) << text;
  }
  std::filesystem::path folder_;
};

std::string binary_stl(const test::Soup& soup, const std::string& header = "", std::uint32_t count_offset = 0) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const auto append = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
  const auto count = static_cast<std::uint32_t>(soup.size()) + count_offset;
  append(&count, 4);
  for (const auto& t : soup) {
    std::array<float, 12> raw{};
    raw[0] = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t d = 0; d < 3; ++d) raw[3 + 3 * i + d] = static_cast<float>(t[i][d]);
    append(raw.data(), 48);
    append("\7\7", 2);
  }
  return bytes;
}

std::string ascii_stl(const test::Soup& soup, const std::string& name, const std::string& newline = "\n") {
  std::string text = "solid " + name + newline;
  for (const auto& t : soup) {
    text += "facet normal 0 0 1" + newline + "outer loop" + newline;
    for (const Point3& x : t) text += fmt::format("vertex {} {} {}", x[0], x[1], x[2]) + newline;
    text += "endloop" + newline + "endfacet" + newline;
  }
  return text + "endsolid " + name + newline;
}

const test::Soup cube = test::box_facets({0, 0, 0}, {1, 1, 1});

TEST_F(ReadMeshTest, ReadsBinaryThoughItsHeaderSaysSolid) {
  const ReadMesh mesh = read_mesh(write("a.stl", binary_stl(cube, "solid facet normal")));
  EXPECT_EQ(mesh.format, "binary STL");
  ASSERT_EQ(mesh.mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.mesh.vertices.size(), 36U);
  EXPECT_DOUBLE_EQ(volume_moments(mesh.mesh).volume, 1.0);
  EXPECT_EQ(mesh.facet_normals[3], Point3{}) << "a normal that is not a number counts as missing";
  EXPECT_EQ(mesh.mesh.region_names, std::vector<std::string>{"surface"});
}

TEST_F(ReadMeshTest, NotesTrailingBytesAndOddNormals) {
  const ReadMesh mesh = read_mesh(write("a.stl", binary_stl(cube) + "tail"));
  ASSERT_EQ(mesh.notes.size(), 2U);
  EXPECT_NE(mesh.notes[0].find("4 bytes"), std::string::npos);
  EXPECT_NE(mesh.notes[1].find("12 stored facet normals"), std::string::npos);
}

TEST_F(ReadMeshTest, RefusesForeignFilesByTheirNameUnlessTheyAreMeshes) {
  expect_refused(write("a.stl", "ISO-10303-21;\nHEADER;\n"), "this is a STEP file");
  expect_refused(write("b.obj", "ISO-10303-21;\nHEADER;\n"), "this is a STEP file");
  expect_refused(write("part.SLDPRT", std::string(300, 'x')), "by its name a SolidWorks part");
  EXPECT_EQ(read_mesh(write("part.step", binary_stl(cube))).format, "binary STL");
  EXPECT_EQ(read_mesh(write("part.igs", ascii_stl(cube, "a"))).format, "ASCII STL");
}

TEST_F(ReadMeshTest, KeepsEveryDigitOfAsciiCoordinates) {
  const double x = 0.1 + 1e-16 + 12345.678901234567;
  const test::Soup far = test::moved(cube, 1, {x, 1e4 / 3, -1e-7 / 3});
  const ReadMesh mesh = read_mesh(write("a.stl", ascii_stl(far, "part")));
  for (std::size_t t = 0; t < 12; ++t)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(mesh.mesh.vertices[3 * t + i], far[t][i]);
}

TEST_F(ReadMeshTest, NamesSolidsUniquely) {
  std::string text = ascii_stl(cube, "Lid", "\r\n") + ascii_stl(test::moved(cube, 1, {5, 0, 0}), "", "\r\n") +
                     ascii_stl(test::moved(cube, 1, {9, 0, 0}), "Lid", "\r");
  for (char& c : text) c = c == 'f' ? 'F' : c;
  const ReadMesh mesh = read_mesh(write("a.stl", text));
  EXPECT_EQ(mesh.format, "ASCII STL");
  EXPECT_EQ(mesh.mesh.region_names, (std::vector<std::string>{"Lid", "surface", "Lid_2"}));
  EXPECT_EQ(mesh.mesh.region[0], 0);
  EXPECT_EQ(mesh.mesh.region[12], 1);
  EXPECT_EQ(mesh.mesh.region[35], 2);
}

TEST_F(ReadMeshTest, AcceptsMissingAndOddNormalsAndPlusSigns) {
  const ReadMesh mesh =
      read_mesh(write("a.stl", "SOLID\nfacet\nouter loop\nVERTEX +0 0 0\nvertex 1.E0 0 0\nvertex 0 1e+0 -0\n"
                               "endloop endfacet facet normal nan -nan(ind) 1\nouter loop vertex 0 0 0 "
                               "vertex 1 0 0 vertex 0 0 1 endloop endfacet endsolid"));
  EXPECT_EQ(mesh.mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.mesh.vertices[1], (Point3{1, 0, 0}));
  EXPECT_EQ(mesh.facet_normals[1], Point3{});
}

TEST_F(ReadMeshTest, ScalesAndHashes) {
  const std::string bytes = binary_stl(cube);
  const ReadMesh mesh = read_mesh(write("a.stl", bytes), 25.4);
  EXPECT_DOUBLE_EQ(volume_moments(mesh.mesh).volume, 25.4 * 25.4 * 25.4);
  EXPECT_EQ(mesh.sha256, io::sha256_text(bytes));
  EXPECT_EQ(io::sha256_file(folder_ / "a.stl"), mesh.sha256);
  EXPECT_EQ(io::sha256_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_THROW(read_mesh(folder_ / "a.stl", 0.0), InputError);
}

TEST_F(ReadMeshTest, RefusesBadFilesWithTheirNameAndReason) {
  expect_refused(folder_ / "none.stl", "no such file");
  expect_refused(folder_, "is a folder");
  expect_refused(write("empty.stl", ""), "empty");
  expect_refused(write("cut.stl", binary_stl(cube).substr(0, 500)), "12 facets (684 bytes), the file has 500 bytes");
  expect_refused(write("short.stl", "hello"), "not an STL file");
  expect_refused(write("text.stl", std::string(400, 'x')), "not an STL file");
  expect_refused(write("nothing.stl", binary_stl({})), "without any facet");
  expect_refused(write("ascii_nothing.stl", "solid a\nendsolid a\n"), "without any facet");
  const std::string text = ascii_stl(cube, "a");
  expect_refused(write("ascii_cut.stl", text.substr(0, text.find("vertex", 400) + 9)), "truncated");
  expect_refused(write("word.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n"),
                 "line 4: found \"zero\"");
  expect_refused(write("nan.stl",
                       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 0\nvertex 1 0 0\nvertex 0 1 0\n"
                       "endloop\nendfacet\nendsolid"),
                 "facet 1");
  test::Soup infinite = cube;
  infinite[4][1][2] = std::numeric_limits<double>::infinity();
  expect_refused(write("inf.stl", binary_stl(infinite)), "facet 5");
}

const char* const obj =
    "# cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1.0000000000000002\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST_F(ReadMeshTest, ReadsObjPlyAndOffInFullPrecision) {
  const ReadMesh from_obj = read_mesh(write("a.obj", obj));
  EXPECT_EQ(from_obj.format, "OBJ");
  EXPECT_EQ(from_obj.mesh.triangles.size(), 12U);
  EXPECT_EQ(from_obj.mesh.vertices[7][2], 1.0000000000000002);
  EXPECT_NEAR(volume_moments(from_obj.mesh).volume, 1, 1e-15);

  const std::string tetrahedron =
      "1e4 0 0\n10001.000000000002 0 0\n1e4 1 0\n1e4 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const ReadMesh from_off = read_mesh(write("a.off", "OFF\n4 4 0\n" + tetrahedron));
  EXPECT_EQ(from_off.format, "OFF");
  EXPECT_EQ(from_off.mesh.vertices[1][0], 10001.000000000002);
  EXPECT_NEAR(volume_moments(from_off.mesh).volume, 1.0 / 6, 1e-12);
  const ReadMesh from_ply =
      read_mesh(write("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
                               "property double z\nelement face 4\nproperty list uchar int vertex_indices\n"
                               "end_header\n" +
                                   tetrahedron));
  EXPECT_EQ(from_ply.format, "PLY");
  EXPECT_EQ(from_ply.mesh.vertices[1][0], 10001.000000000002);
  EXPECT_EQ(from_ply.mesh.triangles.size(), 4U);
}

TEST_F(ReadMeshTest, ReadsObjWithContinuedLinesAndWhatIsNoFace) {
  std::string text = "mtllib a.mtl\no part\n" + std::string(obj) + "l 1 2\np 3\nusemtl red\n";
  text.replace(text.find("f 1 4 3 2"), 9, "f 1 4 \\\r\n  3 2");
  const ReadMesh mesh = read_mesh(write("a.obj", text));
  EXPECT_EQ(mesh.mesh.triangles.size(), 12U);
  EXPECT_NEAR(volume_moments(mesh.mesh).volume, 1, 1e-15);
}

// A plate of thickness 1 over a star with `points` points, radii 2 and 1: neither its top nor its bottom is convex.
std::string star_obj(int points) {
  std::string vertices, top = "f", bottom = "f", sides;
  const int n = 2 * points;
  for (const double z : {0.0, 1.0})
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * 3.14159265358979323846 * i / n, radius = i % 2 == 0 ? 2 : 1;
      vertices += fmt::format("v {} {} {}\n", radius * std::cos(angle), radius * std::sin(angle), z);
    }
  for (int i = 1; i <= n; ++i) {
    top += fmt::format(" {}", n + i);
    bottom += fmt::format(" {}", n + 1 - i);
    const int next = i % n + 1;
    sides += fmt::format("f {} {} {} {}\n", i, next, n + next, n + i);
  }
  return vertices + top + "\n" + bottom + "\n" + sides;
}

TEST_F(ReadMeshTest, CutsFacesOfAnyNumberOfCornersIntoTriangles) {
  // 2 000 corners took minutes and gigabytes with an algorithm that is cubic in them.
  for (const int points : {3, 20, 40, 1000}) {
    const ReadMesh mesh = read_mesh(write("a.obj", star_obj(points)));
    EXPECT_EQ(mesh.mesh.triangles.size(), static_cast<std::size_t>(2 * (2 * points - 2) + 4 * points));
    const double area = 2 * points * std::sin(3.14159265358979323846 / points);
    EXPECT_NEAR(volume_moments(mesh.mesh).volume, area, 1e-12 * area);
    // No triangle lies outside of the star: the areas of top and bottom add up, without signs, to twice the star's.
    double flat = 0;
    for (const Triangle& t : mesh.mesh.triangles) {
      const auto at = [&](std::size_t i) { return mesh.mesh.vertices[static_cast<std::size_t>(t[i])]; };
      if (at(0)[2] != at(1)[2] || at(0)[2] != at(2)[2]) continue;
      flat +=
          0.5 * std::abs((at(1)[0] - at(0)[0]) * (at(2)[1] - at(0)[1]) - (at(1)[1] - at(0)[1]) * (at(2)[0] - at(0)[0]));
    }
    EXPECT_NEAR(flat, 2 * area, 1e-12 * area);
  }
}

TEST_F(ReadMeshTest, ReadsAsciiStlPaddedWithZeros) {
  for (const std::string& padding : {std::string(3, '\0'), std::string("\n\x1A"), std::string(512, '\0')})
    EXPECT_EQ(read_mesh(write("a.stl", ascii_stl(cube, "a") + padding)).mesh.triangles.size(), 12U);
}

TEST_F(ReadMeshTest, RefusesDamagedPolygonFiles) {
  expect_refused(write("a.off", "OFF\n4 4 0\n0 0 0\n1 0"), "line 4: the text ends where a coordinate is expected");
  expect_refused(write("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n"), "PLY");
  expect_refused(write("a.obj", "v 0 0 0\nv 1 0 0\n"), "OBJ");
  expect_refused(write("b.ply", "ply\nnonsense\n"), "line 2: found \"nonsense\"");
}

} // namespace
} // namespace iga::prep
