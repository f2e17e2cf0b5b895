// What igaprep says to bad input: exit code 2, a message that names the fault, and no file.
#include "tests/support/run_program.hpp"
#include "tests/support/small_surfaces.hpp"
#include "tests/support/temp_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace iga::test {
namespace {

struct Case {
  const char* name;
  std::vector<std::string> arguments;
  std::vector<std::string> words; // all of them in the message
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

struct IgaprepRefuses : testing::TestWithParam<Case> {
  TempFolder folder;
  RunOptions options;
  void SetUp() override {
    options.folder = folder.path();
    const std::string cube = ascii_stl(box_mesh({0, 0, 0}, {10, 10, 10}));
    write_bytes(folder / "cube.stl", cube);
    write_bytes(folder / "empty.stl", "");
    write_bytes(folder / "ascii_truncated.stl", cube.substr(0, cube.size() / 2));
    write_bytes(folder / "notes.stl", "Dear reader, this is no surface.\n");
    write_bytes(folder / "no_facets.stl", "solid nothing\nendsolid nothing\n");
    std::string nan = cube;
    nan.replace(nan.find("vertex 0"), 8, "vertex nan");
    write_bytes(folder / "nan.stl", nan);
    std::string binary(84 + 100, '\0');
    binary[80] = 12; // promises 12 facets, holds two
    write_bytes(folder / "binary_truncated.stl", binary);
    TriangleMesh flat = box_mesh({0, 0, 0}, {10, 10, 0});
    write_bytes(folder / "flat.stl", ascii_stl(flat));
    TriangleMesh open = box_mesh({0, 0, 0}, {10, 10, 10});
    open.triangles.pop_back();
    write_bytes(folder / "open.stl", ascii_stl(open));
    write_bytes(folder / "unknown.toml", "input = \"cube.stl\"\n\n[grid]\ndegre = 2\n");
    write_bytes(folder / "type.toml", "input = \"cube.stl\"\n[grid]\nspan_size = \"ten\"\n");
    write_bytes(folder / "broken.toml", "input = \n");
  }
};

TEST_P(IgaprepRefuses, WithCodeTwoAndAMessage) {
  const auto before = entries(folder.path());
  const ProgramRun run = run_program(IGAPREP, GetParam().arguments, options);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.out, "");
  for (const std::string& word : GetParam().words)
    EXPECT_NE(run.err.find(word), std::string::npos) << word << " is missing in: " << run.err;
  EXPECT_EQ(entries(folder.path()), before);
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, IgaprepRefuses,
    testing::Values(
        Case{"NoArgument", {}, {"no surface", "--help"}},
        Case{"Missing", {"absent.stl"}, {"absent.stl", "no such file"}}, Case{"Folder", {"."}, {"error"}},
        Case{"Empty", {"empty.stl"}, {"empty.stl"}},
        Case{"AsciiTruncated", {"ascii_truncated.stl"}, {"ascii_truncated.stl"}},
        Case{"BinaryTruncated", {"binary_truncated.stl"}, {"binary_truncated.stl"}},
        Case{"NotASurface", {"notes.stl"}, {"notes.stl"}}, Case{"NoFacets", {"no_facets.stl"}, {"no_facets.stl"}},
        Case{"NotANumber", {"nan.stl"}, {"nan.stl"}}, Case{"NoVolume", {"flat.stl"}, {"error"}},
        Case{"Open", {"open.stl"}, {"--repair"}},
        Case{"BoxMisses", {"cube.stl", "--box", "20", "0", "0", "30", "10", "10"}, {"misses"}},
        Case{"BoxTooSmall", {"cube.stl", "--box", "-1", "-1", "-1", "11", "9", "11"}, {"sticks out", "along y"}},
        Case{"BoxEmpty", {"cube.stl", "--box", "0", "0", "0", "10", "10", "0"}, {"empty along z"}},
        Case{"BoxIncomplete", {"cube.stl", "--box", "0", "0", "0"}, {"box: found 3", "expected 6"}},
        Case{"SizeZero", {"cube.stl", "--span-size", "0"}, {"span_size = 0", "positive"}},
        Case{"SizeNegative", {"cube.stl", "--span-size", "-3"}, {"span_size = -3", "positive"}},
        Case{"SizeNan", {"cube.stl", "--span-size", "nan"}, {"positive"}},
        Case{"SizeWord", {"cube.stl", "--span-size=ten"}, {"--span-size", "ten"}},
        Case{"SpansZero", {"cube.stl", "--spans", "0"}, {"spans = 0"}},
        Case{"ScaleZero", {"cube.stl", "--scale", "0"}, {"scale = 0"}},
        Case{"ScaleNegative", {"cube.stl", "--scale", "-1"}, {"scale = -1"}},
        Case{"DegreeZero", {"cube.stl", "--degree", "0"}, {"degree = 0", "1 … 4"}},
        Case{"DegreeNine", {"cube.stl", "--degree", "9"}, {"degree = 9", "1 … 4"}},
        Case{"SizeTiny", {"cube.stl", "--span-size", "1e-300"}, {"GiB", "1e+301 × "}},
        Case{"TooLarge", {"cube.stl", "--scale", "1e200"}, {"diagonal", "--scale"}},
        Case{"TooSmall", {"cube.stl", "--scale", "1e-200"}, {"diagonal", "--scale"}},
        Case{"TooManySpans", {"cube.stl", "--spans", "10000"}, {"GiB", "span_size"}},
        Case{"UnknownFlag", {"cube.stl", "--span-sise", "3"}, {"did you mean --span-size"}},
        Case{"UnknownRule", {"cube.stl", "--quadrature", "simpson"}, {"simpson", "gauss"}},
        Case{"UnknownKey", {"unknown.toml"}, {"unknown.toml:4", "'degre'", "did you mean 'degree'"}},
        Case{"WrongType", {"type.toml"}, {"type.toml:3", "the text \"ten\"", "number"}},
        Case{"BrokenToml", {"broken.toml"}, {"broken.toml:1"}}, Case{"MissingToml", {"absent.toml"}, {"absent.toml"}},
        Case{"NoOutputFolder", {"cube.stl", "-o", "nowhere/a.h5"}, {"nowhere", "does not exist"}},
        Case{"OutputIsAFolder", {"cube.stl", "-o", ".", "--force"}, {"is a folder", "./ for one model"}},
        Case{"OutputIsADevice", {"cube.stl", "-o", "/dev/full", "--force"}, {"/dev/full", "no ordinary file"}},
        Case{"OutputIsTheInput", {"cube.stl", "-o", "cube.stl", "--force"}, {"never replaced"}}),
    [](const auto& test) { return test.param.name; });

struct IgaprepOutput : IgaprepRefuses {};

TEST_F(IgaprepOutput, UnwritableFolderIsRefusedBeforeWorkStarts) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write anywhere";
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const ProgramRun run = run_program(IGAPREP, {"cube.stl"}, options);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("not writable"), std::string::npos) << run.err;
}

TEST_F(IgaprepOutput, FullDiskLeavesTheOldFileAndNoHalfOne) {
  write_bytes(folder / "cube.h5", "the old file");
  const auto before = entries(folder.path());
  options.file_size_limit = 4096;
  const ProgramRun run = run_program(IGAPREP, {"cube.stl", "--force"}, options);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find("cube.h5"), std::string::npos) << run.err;
  EXPECT_EQ(read_bytes(folder / "cube.h5"), "the old file");
  EXPECT_EQ(entries(folder.path()), before);
}

} // namespace
} // namespace iga::test
