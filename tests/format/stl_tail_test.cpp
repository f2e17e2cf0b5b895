// What stands behind the facets that an STL announces: geometry is read or refused, never passed over in silence.
#include "format/io/stl_reader.hpp"
#include "format/model/errors.hpp"

#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace iga::io {
namespace {

std::string header(std::uint32_t count) {
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  return bytes;
}

std::string facets(int number, float shift = 0) {
  std::string bytes;
  for (int f = 0; f < number; ++f) {
    const float at = shift + static_cast<float>(f);
    const float raw[12] = {0, 0, 1, at, 0, 0, at + 1, 0, 0, at, 1, 0};
    bytes.append(reinterpret_cast<const char*>(raw), sizeof raw).append(2, '\0');
  }
  return bytes;
}

std::string stl(int number, float shift = 0) {
  return header(static_cast<std::uint32_t>(number)) + facets(number, shift);
}

std::string refusal(const std::string& bytes) {
  try {
    read_stl(bytes, "part", 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(StlTail, ReadsFurtherFacetsAndSaysSo) {
  for (const int announced : {0, 1, 5}) {
    const StlMesh mesh = read_stl(header(static_cast<std::uint32_t>(announced)) + facets(8), "part", 1);
    EXPECT_EQ(mesh.mesh.triangles.size(), 8U);
    EXPECT_EQ(mesh.mesh.vertices[21][0], 7);
    ASSERT_EQ(mesh.notes.size(), 1U);
    EXPECT_EQ(mesh.notes[0], fmt::format("the header announces {} facets, but {} more follow them; they were read too",
                                         announced, 8 - announced));
  }
}

TEST(StlTail, ReadsFilesOneAfterTheOtherAsRegions) {
  const StlMesh mesh = read_stl(stl(2) + stl(3, 10) + stl(1, 20), "part", 1);
  EXPECT_EQ(mesh.mesh.triangles.size(), 6U);
  EXPECT_EQ(mesh.mesh.vertices[6][0], 10);
  EXPECT_EQ(mesh.mesh.region, (std::vector<std::int32_t>{0, 0, 1, 1, 1, 2}));
  ASSERT_EQ(mesh.notes.size(), 1U);
  EXPECT_NE(mesh.notes[0].find("3 binary STL files stand one after the other"), std::string::npos);
}

TEST(StlTail, PassesOverPaddingTextAndCrumbsWithANote) {
  for (const auto& [tail, words] :
       {std::pair{std::string(100, '\0'), "100 bytes after the last facet were ignored (all zero)"},
        std::pair{std::string(49, '\7'), "49 bytes after the last facet were ignored"},
        std::pair{std::string(50, 'x'), "50 bytes after the last facet were ignored (text: \"xxx"},
        std::pair{std::string("\r\nmade by hand"), "(text: \""}}) {
    const StlMesh mesh = read_stl(stl(2) + tail, "part", 1);
    EXPECT_EQ(mesh.mesh.triangles.size(), 2U);
    ASSERT_EQ(mesh.notes.size(), 1U);
    EXPECT_NE(mesh.notes[0].find(words), std::string::npos) << mesh.notes[0];
  }
}

TEST(StlTail, RefusesWhatMayBeGeometryAndCannotBeRead) {
  const std::string said = "behind the 2 facets that the header announces follow";
  EXPECT_NE(refusal(stl(2) + facets(3).substr(0, 149)).find(said + " 149 more bytes"), std::string::npos);
  EXPECT_NE(refusal(stl(2) + stl(3).substr(0, 230)).find(said + " 230 more bytes"), std::string::npos);
  EXPECT_NE(refusal(stl(2) + facets(1, 1e9F)).find(said), std::string::npos);
  std::string nan = facets(1);
  std::memset(nan.data() + 12, 0xFF, 4);
  EXPECT_NE(refusal(stl(2) + nan).find(said), std::string::npos);
  const std::string ascii =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nendsolid a\n";
  EXPECT_NE(refusal(stl(2) + ascii).find("follows an ASCII STL"), std::string::npos);
  EXPECT_NE(refusal(header(0) + std::string(333, '\1')).find("not an STL file"), std::string::npos);

  EXPECT_EQ(read_stl(ascii + ascii, "part", 1).mesh.triangles.size(), 2U);
  EXPECT_EQ(read_stl(ascii + "made by hand\n", "part", 1).notes.size(), 1U);
  std::string long_ascii;
  for (int n = 0; n < 50; ++n) long_ascii += ascii;
  EXPECT_NE(refusal(long_ascii + stl(2)).find("line 451: behind the last solid"), std::string::npos);
  EXPECT_NE(refusal(ascii + "sold b\nfacet normal 0 0 1\n").find("line 10: behind the last solid"), std::string::npos);
}

TEST(StlTail, NamesThousandsOfEqualSolidsAtOnce) {
  std::string text;
  for (int n = 0; n < 6000; ++n) text += "solid a\nendsolid\n";
  EXPECT_NE(refusal(text).find("without any facet"), std::string::npos); // cubic in the solids once
}

} // namespace
} // namespace iga::io
