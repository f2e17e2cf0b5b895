// OBJ, PLY and OFF: the variants that other programs write are read to the bit, damage is refused with its line.
#include "format/io/obj_reader.hpp"
#include "format/io/off_reader.hpp"
#include "format/io/ply_reader.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace iga::io {
namespace {

using Read = PolygonSoup (*)(std::string_view, const std::string&);

std::string refusal(Read read, const std::string& text) {
  try {
    read(text, "part");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_refused(Read read, const std::string& text, const std::string& words) {
  const std::string said = refusal(read, text);
  EXPECT_EQ(said.rfind("part: ", 0), 0U) << said;
  EXPECT_NE(said.find(words), std::string::npos) << words << " is missing in: " << said;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// A tetrahedron; the third vertex needs all digits of a double.
const std::vector<Point3> points{{0, 0, 0}, {1, 0, 0}, {0, 1.0000000000000002, 0}, {0, 0, 1}};
const std::vector<std::int32_t> corners{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

void expect_tetrahedron(const PolygonSoup& soup, const std::string& which) {
  EXPECT_EQ(soup.points, points) << which;
  EXPECT_EQ(soup.corners, corners) << which;
  EXPECT_EQ(soup.offsets, (std::vector<std::size_t>{0, 3, 6, 9, 12})) << which;
  EXPECT_TRUE(soup.notes.empty()) << which;
}

const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1.0000000000000002 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1.0000000000000002 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n" +
    off.substr(off.find("0 0 0"));

TEST(ObjReader, ReadsTabsLineEndsContinuationsAndAllThatIsNoShape) {
  expect_tetrahedron(read_obj(obj, "part"), "plain");
  expect_tetrahedron(read_obj(replaced(obj, " ", "\t"), "part"), "tabs");
  expect_tetrahedron(read_obj(replaced(obj, "\n", "\r"), "part"), "CR");
  expect_tetrahedron(read_obj(replaced(obj, "\n", "\r\n"), "part"), "CR LF");
  expect_tetrahedron(read_obj(replaced(obj, "f 1 3 2", "f 1 \\\n 3\\\r\n\\\n 2"), "part"), "continued");
  expect_tetrahedron(read_obj(replaced(obj, "f 2 3 4\n", "f 2 3\\\n 4\\"), "part"), "continued beyond the end");
  expect_tetrahedron(read_obj(replaced(replaced(obj, "f 1 3 2", "f 1/1 3/2/7 2//3"), "f 1 2 4", "f -4 -3 -1"), "part"),
                     "textures, normals, counted back");
  expect_tetrahedron(read_obj("\xEF\xBB\xBF# a\nmtllib a.mtl\no b c\n" +
                                  replaced(obj, "0 0 1\n", "0 0 1 1 0.5 .5 # c\n") +
                                  "vt 0 0\nvn 0 0 1\ng\ns off\nusemtl \xC3\xB6\nl 1 2\np 3\n",
                              "part"),
                     "what is no shape");
  const std::size_t faces = obj.find("f 1");
  expect_tetrahedron(read_obj(obj.substr(faces) + obj.substr(0, faces), "part"), "faces first");
}

TEST(ObjReader, RefusesWithLineAndToken) {
  expect_refused(read_obj, replaced(obj, "f 1 3 2", "f 0 3 2"),
                 "line 5: found \"0\": vertices are counted from 1, there is no index 0");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 f 4"),
                 "line 6: found \"f\" where the number of a vertex is expected");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2.5 4"), "line 6: found \"2.5\"");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2/x 4"), "line 6: found \"2/x\"");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2 5"), "line 6: a face names vertex \"5\", the file has 4");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2 2147483649"), "line 6: a face names vertex \"2147483649\"");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2 99999999999999999999"),
                 "line 6: found \"99999999999999999999\"");
  expect_refused(read_obj, replaced(obj, "f 1 2 4", "f 1 2 -5"), "line 6: found \"-5\"");
  expect_refused(read_obj, replaced(obj, "v 1 0 0", "v 1 0"), "line 2: the line ends where a coordinate is expected");
  expect_refused(read_obj, replaced(obj, "v 1 0 0", "v 1 0,5 0"), "line 2: found \"0,5\"");
  expect_refused(read_obj, replaced(obj, "v 1 0 0", "v 1 0,5 0"), "with a point, not a comma");
  expect_refused(read_obj, replaced(obj, "v 1 0 0", "v 1 nan 0"), "line 2: found \"nan\"");
  expect_refused(read_obj, replaced(obj, "v 1 0 0", "w 1 0 0"), "line 2: found \"w\" where a keyword of OBJ");
  expect_refused(read_obj, "surf 0 1 0 1 1 2\n", "free-form surfaces");
}

TEST(ObjReader, LeavesOutFacesWithFewerThanThreeCornersAndSaysSo) {
  const PolygonSoup soup = read_obj(obj + "f 1 2\nf\n", "part");
  EXPECT_EQ(soup.num_polygons(), 4U);
  ASSERT_EQ(soup.notes.size(), 1U);
  EXPECT_EQ(soup.notes[0], "2 faces with fewer than three corners left out (the first in line 9)");
}

TEST(OffReader, ReadsHeadersLineEndsAndRecordsOverLines) {
  expect_tetrahedron(read_off(off, "part"), "plain");
  for (const char* header : {"OFF 4 4 6\n", "OFF4 4 6\n", "off\n# a\n\n4 4 6 # b\n", "4 4 6\n", "OFF\n4 4\n",
                             "OFF\n4 4\n6\n", "OFF\n4\n4\n6\n"})
    expect_tetrahedron(read_off(replaced(off, "OFF\n4 4 6\n", header), "part"), header);
  expect_tetrahedron(read_off(replaced(off, "\n", "\r"), "part"), "CR");
  expect_tetrahedron(read_off(replaced(off, "\n", "\r\n") + std::string(3, '\0'), "part"), "CR LF and padding");
  expect_tetrahedron(read_off(replaced(off, " ", "\n"), "part"), "a number a line");
  expect_tetrahedron(read_off(replaced(off, "\n", " "), "part"), "all in one line");
  expect_tetrahedron(read_off(replaced(replaced(off, "0 0 0\n", "0 0 0 "), "3 0 2 1\n", "3 0 2 1 "), "part"),
                     "two in a line");
  expect_tetrahedron(
      read_off(replaced(replaced(off, "3 0 1 3", "3 0 1 3 255 0 0"), "3 1 2 3", "3 1 2 3 0.5 0.5 0.5 1"), "part"),
      "colours of faces");
  expect_tetrahedron(read_off(replaced(replaced(off, "OFF", "COFF"), "1 0 0\n", "1 0 0 255 0 0 255\n"), "part"),
                     "colours of vertices");
}

TEST(OffReader, ReadsNormalsAndTexturesInLinesAndAcrossThem) {
  const std::string with = "STNOFF 4 4 0\n0 0 0 0 0 1 .5 .5\n1 0 0 0 0 1 .5 .5\n0 1.0000000000000002 0 0 0 1 .5 .5\n"
                           "0 0 1 0 0 1 .5 .5\n" +
                           off.substr(off.find("3 0 2 1"));
  expect_tetrahedron(read_off(with, "part"), "in lines");
  expect_tetrahedron(read_off(replaced(with, " ", "\n"), "part"), "a number a line");
}

TEST(OffReader, RefusesWithLineAndToken) {
  expect_refused(read_off, replaced(off, "3 0 1 3", "3 0 1 4"),
                 "line 8: a face names vertex \"4\", the file has 4 vertices, counted from 0");
  expect_refused(read_off, replaced(off, "3 0 1 3", "3 0 -1 3"), "line 8: a face names vertex \"-1\"");
  expect_refused(read_off, replaced(off, "3 0 1 3", "3 0 a 3"), "line 8: found \"a\"");
  expect_refused(read_off, replaced(off, "1 0 0\n", "1 x 0\n"), "line 4: found \"x\" where a coordinate is expected");
  expect_refused(read_off, replaced(off, "4 4 6", "4 5 6"), "line 11: the text ends");
  expect_refused(read_off, replaced(off, "4 4 6", "4 3 6"), "line 10: found \"3\" behind the last of the 3 faces");
  expect_refused(read_off, replaced(off, "4 4 6", "4 -4 6"), "line 2: found \"-4\"");
  expect_refused(read_off, replaced(off, "OFF", "OFF BINARY"), "binary OFF");
  expect_refused(read_off, replaced(off, "OFF", "4OFF"), "another dimension");
  expect_refused(read_off, "OFF\n2147483647 2147483647 0\n0 0 0\n", "line 4: the text ends");
}

// The tetrahedron as binary PLY, with an index type, byte order and line end; further properties and elements around
// it.
template <class Index> std::string binary_ply(const char* index, bool big, const std::string& newline) {
  std::string text =
      fmt::format("ply\nformat binary_{}_endian 1.0\ncomment a\nobj_info b\nelement camera 2\nproperty float t\n"
                  "property list uchar short u\nelement vertex 4\nproperty uchar red\nproperty double x\n"
                  "property double y\nproperty double z\nelement face 4\nproperty float quality\n"
                  "property list {} {} vertex_index\nproperty list uint8 float texcoord\nend_header\n",
                  big ? "big" : "little", index, index);
  text = replaced(text, "\n", newline);
  const auto append = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big) std::reverse(raw, raw + sizeof value);
    text.append(raw, sizeof value);
  };
  for (int c = 0; c < 2; ++c) {
    append(1.5F);
    append(static_cast<std::uint8_t>(2));
    append(static_cast<std::int16_t>(7));
    append(static_cast<std::int16_t>(8));
  }
  for (const Point3& x : points) {
    append(static_cast<std::uint8_t>('\n'));
    for (const double value : x) append(value);
  }
  for (std::size_t f = 0; f < 4; ++f) {
    append(0.5F);
    append(static_cast<Index>(3));
    for (std::size_t i = 0; i < 3; ++i) append(static_cast<Index>(corners[3 * f + i]));
    append(static_cast<std::uint8_t>(1));
    append(0.25F);
  }
  return text;
}

TEST(PlyReader, ReadsEveryIndexTypeAndByteOrder) {
  for (const bool big : {false, true})
    for (const char* newline : {"\n", "\r\n", "\r"}) {
      expect_tetrahedron(read_ply(binary_ply<std::int8_t>("char", big, newline), "part"), "char");
      expect_tetrahedron(read_ply(binary_ply<std::uint8_t>("uint8", big, newline), "part"), "uint8");
      expect_tetrahedron(read_ply(binary_ply<std::int16_t>("short", big, newline), "part"), "short");
      expect_tetrahedron(read_ply(binary_ply<std::uint16_t>("ushort", big, newline), "part"), "ushort");
      expect_tetrahedron(read_ply(binary_ply<std::int32_t>("int32", big, newline), "part"), "int32");
      expect_tetrahedron(read_ply(binary_ply<std::uint32_t>("uint", big, newline), "part"), "uint");
    }
}

// With CR alone, data that begin with the byte of LF still begin there.
TEST(PlyReader, KeepsAFirstByteThatLooksLikeALineEnd) {
  std::string text =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty char x\rproperty char y\rproperty "
      "char z\relement face 0\rproperty list uchar int vertex_indices\rend_header\r\n\n\n";
  EXPECT_EQ(read_ply(text, "part").points.at(0), (Point3{10, 10, 10}));
}

TEST(PlyReader, ReadsAsciiOverAnyLines) {
  expect_tetrahedron(read_ply(ply, "part"), "plain");
  expect_tetrahedron(read_ply(replaced(ply, "\n", "\r"), "part"), "CR");
  expect_tetrahedron(read_ply(replaced(ply, "\n", "\r\n"), "part"), "CR LF");
  const std::size_t data = ply.find("0 0 0");
  expect_tetrahedron(read_ply(ply.substr(0, data) + replaced(ply.substr(data), " ", "\n"), "part"), "a number a line");
  expect_tetrahedron(read_ply(ply.substr(0, data) + replaced(ply.substr(data), "\n", " "), "part"), "all in one line");
  EXPECT_EQ(read_ply(replaced(replaced(ply, "double", "float"), "1 0 0", "0.1 0 0"), "part").points[1][0], 0.1F)
      << "a float has the precision that the header declares";
}

TEST(PlyReader, RefusesBadHeadersWithTheirLine) {
  expect_refused(read_ply, replaced(ply, "element vertex", "elment vertex"),
                 "line 3: found \"elment\" where format, element");
  expect_refused(read_ply, replaced(ply, "element vertex 4\n", ""),
                 "line 3: found \"property\" before any line \"element");
  expect_refused(read_ply, replaced(ply, "element vertex 4", "element vertex"), "line 3: the line ends where a count");
  expect_refused(read_ply, replaced(ply, "element vertex 4", "element vertex -4"), "line 3: found \"-4\"");
  expect_refused(read_ply, replaced(ply, "element face 4", "element vertex 4"), "line 7: a second element \"vertex\"");
  expect_refused(read_ply, replaced(ply, "double z", "dble z"), "line 6: found \"dble\" where a type");
  expect_refused(read_ply, replaced(ply, "list uchar int", "list float int"),
                 "line 8: the length of a list cannot be a float");
  expect_refused(read_ply, replaced(ply, "ascii", "text"), "line 2: found \"text\"");
  expect_refused(read_ply, replaced(ply, "format ascii 1.0\n", ""), "no line \"format");
  expect_refused(read_ply, replaced(ply, "end_header", "comment"), "line 10: found \"0\"");
  expect_refused(read_ply, ply.substr(0, ply.find("property double z")), "truncated: the PLY header ends in line 5");
  expect_refused(read_ply, replaced(ply, "double z", "double w"), "no number \"z\"");
  expect_refused(read_ply, replaced(ply, "element face 4", "element edge 4"), "cloud of points");
  expect_refused(read_ply, replaced(ply, "element face", "element tristrips"), "triangle strips");
  expect_refused(read_ply, replaced(ply, "vertex_indices", "indices"), "no list \"vertex_indices\"");
}

TEST(PlyReader, RefusesBadDataWithItsPlace) {
  expect_refused(read_ply, replaced(ply, "3 0 1 3", "3 0 1 4"),
                 "line 15: face 2 (counted from 1) names vertex \"4\", the file has 4");
  expect_refused(read_ply, replaced(ply, "3 0 1 3", "3 0 -1 3"), "names vertex \"-1\"");
  expect_refused(read_ply, replaced(ply, "3 0 1 3", "3 0 1.5 3"), "names vertex \"1.5\"");
  expect_refused(read_ply, replaced(ply, "3 0 1 3", "3 0 x 3"), "line 15: found \"x\" where a number is expected");
  expect_refused(read_ply, replaced(ply, "3 0 1 3", "-3 0 1 3"),
                 "line 15: a list \"vertex_indices\" has the length -3");
  expect_refused(read_ply, replaced(ply, "0 0 1\n", "0 0 inf\n"), "vertex 4 (counted from 1, line 13)");
  expect_refused(read_ply, replaced(ply, "face 4", "face 5"), "line 18: the text ends");
  expect_refused(read_ply, replaced(ply, "face 4", "face 3"),
                 "line 17: found \"3\" behind all that the header announces");
  expect_refused(read_ply, replaced(ply, "vertex 4", "vertex 4000000000"), "too many");
  const std::string binary = binary_ply<std::int32_t>("int", false, "\n");
  expect_refused(read_ply, binary.substr(0, binary.size() - 1), "truncated");
  expect_refused(read_ply, replaced(binary, "face 4", "face 3"), "25 more bytes behind all that the header announces");
  expect_refused(read_ply, replaced(binary, "camera 2", "camera 9000000000000000000"), "truncated");
}

} // namespace
} // namespace iga::io
