// igaprep as a user meets it: a part in, a model file and a report out, nothing done twice.
#include "format/io/trimmed_model_io.hpp"
#include "tests/pipeline/json_text.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/small_surfaces.hpp"
#include "tests/support/temp_folder.hpp"

#include <cmath>
#include <csignal>
#include <gtest/gtest.h>

namespace iga::test {
namespace {

struct Igaprep : testing::Test {
  TempFolder folder;
  RunOptions options;

  void SetUp() override {
    options.folder = folder.path();
    write_bytes(folder / "cube.stl", ascii_stl(box_mesh({0, 0, 0}, {100, 80, 60})));
  }
  ProgramRun run(const std::vector<std::string>& arguments) { return run_program(IGAPREP, arguments, options); }
  std::map<std::string, std::string> json(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ProgramRun done = run(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return parse_json(done.out);
  }
};

double number(const std::map<std::string, std::string>& json, const std::string& path) {
  const auto found = json.find(path);
  EXPECT_NE(found, json.end()) << path;
  return found == json.end() ? 0 : std::stod(found->second);
}

TEST_F(Igaprep, WritesOneFileNamedAfterThePart) {
  const ProgramRun done = run({"cube.stl", "--span-size", "10"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(entries(folder.path()), (std::vector<std::string>{"cube.h5", "cube.stl"}));
  for (const char* word : {"100 × 80 × 60", "12 triangles", "14 × 12 × 10 spans", "interior", "volume", "written"})
    EXPECT_NE(done.out.find(word), std::string::npos) << word << " is missing in:\n" << done.out;
}

TEST_F(Igaprep, ReportsOneJsonObjectWithAllThatScriptsNeed) {
  const auto r = json({"cube.stl", "--span-size", "9", "-o", "a.h5"});
  EXPECT_NEAR(number(r, "volume"), 480000, 480000e-9);
  EXPECT_NEAR(number(r, "mesh_volume"), 480000, 1e-6);
  EXPECT_LE(number(r, "volume_error"), 1e-9);
  EXPECT_NEAR(number(r, "centroid.0"), 50, 1e-6);
  EXPECT_NEAR(number(r, "area"), 2 * (8000 + 6000 + 4800), 1e-6);
  EXPECT_EQ(number(r, "spans.interior") + number(r, "spans.trimmed") + number(r, "spans.exterior"),
            number(r, "grid.spans.0") * number(r, "grid.spans.1") * number(r, "grid.spans.2"));
  EXPECT_EQ(number(r, "points_interior") + number(r, "points_trimmed"), number(r, "points"));
  EXPECT_LE(number(r, "max_residual"), 1e-10);
  EXPECT_EQ(number(r, "bodies"), 1);
  EXPECT_EQ(number(r, "grid.span_size.0"), 9);
  EXPECT_EQ(r.at("reused"), "false");
  EXPECT_EQ(r.at("output"), "a.h5");
  for (const char* key :
       {"snapped_spans", "snapped_volume", "dropped_volume", "cavities", "light_functions", "functions", "warnings.#",
        "findings.#", "grid.A.0", "grid.B.2", "grid.degree.1", "timings.trim", "timings.quadrature", "peak_memory_mib"})
    EXPECT_TRUE(r.contains(key)) << key;
}

TEST_F(Igaprep, DoesNothingWhereAMatchingFileStands) {
  ASSERT_EQ(run({"cube.stl", "--span-size", "20"}).exit_code, 0);
  const std::string first = read_bytes(folder / "cube.h5");
  const ProgramRun again = run({"cube.stl", "--span-size", "20", "20", "20", "--threads", "1"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("nothing to do"), std::string::npos) << again.out;
  EXPECT_EQ(read_bytes(folder / "cube.h5"), first);
  const auto report = json({"cube.stl", "--span-size", "20"});
  EXPECT_EQ(report.at("reused"), "true");
  EXPECT_NEAR(number(report, "volume"), 480000, 480000e-9);
}

TEST_F(Igaprep, KeepsAFileThatDoesNotMatchUnlessForced) {
  ASSERT_EQ(run({"cube.stl", "--span-size", "20"}).exit_code, 0);
  const std::string first = read_bytes(folder / "cube.h5");
  const ProgramRun other = run({"cube.stl", "--span-size", "25"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("other settings"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("--force"), std::string::npos) << other.err;
  EXPECT_EQ(read_bytes(folder / "cube.h5"), first);

  write_bytes(folder / "cube.stl", ascii_stl(box_mesh({0, 0, 0}, {100, 80, 61})));
  const ProgramRun changed = run({"cube.stl", "--span-size", "20"});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_NE(changed.err.find("another input"), std::string::npos) << changed.err;
  EXPECT_EQ(read_bytes(folder / "cube.h5"), first);

  EXPECT_EQ(run({"cube.stl", "--span-size", "20", "--force"}).exit_code, 0);
  EXPECT_NE(read_bytes(folder / "cube.h5"), first);
}

TEST_F(Igaprep, KeepsAForeignFile) {
  write_bytes(folder / "cube.h5", "my notes");
  EXPECT_EQ(run({"cube.stl"}).exit_code, 2);
  EXPECT_EQ(read_bytes(folder / "cube.h5"), "my notes");
}

TEST_F(Igaprep, TakesASettingsFileAndLetsFlagsOverrideIt) {
  std::filesystem::create_directory(folder / "sub");
  write_bytes(folder / "sub/prep.toml",
              "input = \"../cube.stl\"\noutput = \"cube.h5\"\n[grid]\nspan_size = 20\ndegree = 1\n");
  const auto r = json({"sub/prep.toml", "--degree", "3", "2", "1"});
  EXPECT_TRUE(std::filesystem::exists(folder / "sub/cube.h5"));
  EXPECT_EQ(number(r, "grid.span_size.0"), 20);
  EXPECT_EQ(number(r, "grid.degree.0"), 3);
  EXPECT_EQ(number(r, "grid.degree.2"), 1);
}

TEST_F(Igaprep, ListsOfValuesMayStandBeforeTheFileName) {
  const auto r = json({"--span-size", "20", "--box", "-10", "-.5e1", "-10", "110", "95", "70", "cube.stl"});
  EXPECT_EQ(number(r, "grid.A.1"), -5);
  EXPECT_EQ(number(r, "grid.spans.0"), 6);
}

TEST_F(Igaprep, TurnsAndShiftsTheGrid) {
  const auto r = json({"cube.stl", "--spans", "9", "--rotate-axis-angle", "1", "1", "0", "25", "--optimise-offset"});
  EXPECT_NEAR(number(r, "volume"), 480000, 480000e-9);
  EXPECT_LE(number(r, "offset.light_after"), number(r, "offset.light_before"));
  EXPECT_GT(number(r, "spans.trimmed"), 0);
}

// Names in Latin-1 are no UTF-8: the report and the file hold valid text all the same.
TEST_F(Igaprep, ReportsValidJsonForAnyName) {
  const std::string latin = "Geh\xE4use \"2\".stl";
  write_bytes(folder / latin, ascii_stl(box_mesh({0, 0, 0}, {10, 10, 10})));
  const auto r = json({latin, "--span-size", "5", "-o", "a.h5"});
  EXPECT_EQ(r.at("input"), "Geh\xEF\xBF\xBDuse \"2\".stl");
  EXPECT_EQ(json({latin, "--span-size", "5", "-o", "a.h5"}).at("reused"), "true");
}

// A box, turned out of the axes.
TriangleMesh turned_box(const Point3& lower, const Point3& upper) {
  TriangleMesh mesh = box_mesh(lower, upper);
  for (Point3& x : mesh.vertices) {
    const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(1.1), t = std::sin(1.1);
    x = {c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]};
    x = {x[0], d * x[1] - t * x[2], t * x[1] + d * x[2]};
  }
  return mesh;
}

// Exact cuts, rounded to double, leave needles whose normals mean nothing.
TEST_F(Igaprep, UnitesBodiesWhoseUnionHasNeedles) {
  for (const double overlap : {0.5, 1e-3, 1e-5}) {
    const TriangleMesh a = turned_box({0, 0, 0}, {1, 1, 1}), b = turned_box({1 - overlap, 0.2, 0.2}, {1.5, 0.8, 0.8});
    write_bytes(folder / "two.stl", ascii_stl(a) + ascii_stl(b));
    EXPECT_EQ(run({"two.stl", "--spans", "8", "-o", "a.h5", "--force"}).exit_code, 2);
    const auto r = json({"two.stl", "--spans", "8", "-o", "a.h5", "--force", "--repair"});
    EXPECT_NEAR(number(r, "volume"), 1 + 0.5 * 0.36, 1e-9);
  }
}

// A switch that is not typed leaves the settings file alone.
TEST_F(Igaprep, SettingsFileSwitchesStayOnUnlessAFlagTurnsThemOff) {
  const TriangleMesh a = turned_box({0, 0, 0}, {1, 1, 1}), b = turned_box({0.5, 0.2, 0.2}, {1.5, 0.8, 0.8});
  write_bytes(folder / "two.stl", ascii_stl(a) + ascii_stl(b));
  write_bytes(folder / "prep.toml",
              "input = \"two.stl\"\noutput = \"a.h5\"\n[surface]\nrepair = true\n[grid]\nspans = 8\n");
  EXPECT_NEAR(number(json({"prep.toml"}), "volume"), 1 + 0.5 * 0.36, 1e-9);
  EXPECT_EQ(run({"prep.toml", "--force", "--no-repair"}).exit_code, 2);
}

// A cavity that touches the outside leaves a wall without thickness: no span there holds its surface points.
TEST_F(Igaprep, RefusesAWallWithoutMaterialAndWrapsIt) {
  TriangleMesh cavity = turned_box({-1, 0, 0}, {1, 1, 1});
  for (Triangle& t : cavity.triangles) std::swap(t[1], t[2]);
  write_bytes(folder / "wall.stl", ascii_stl(turned_box({-1, -1, -1}, {2, 2, 2})) + ascii_stl(cavity));
  const ProgramRun refused = run({"wall.stl", "-o", "a.h5", "--spans", "16"});
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  for (const char* word : {"wall without material", "--sliver-tolerance", "--wrap"})
    EXPECT_NE(refused.err.find(word), std::string::npos) << refused.err;
  const auto r = json({"wall.stl", "-o", "a.h5", "--spans", "16", "--wrap", "--wrap-alpha", "0.5"});
  EXPECT_NEAR(number(r, "volume"), 27, 3); // the cavity has no opening: it is filled, and the report says so
  EXPECT_NE(r.at("warnings.0").find("filled"), std::string::npos);
}

// Skins of a span's depth times 0.37e-k over faces in grid planes: whatever their depth and the sliver tolerance, the
// model holds them, or takes them for rounding.
TEST_F(Igaprep, SkinsOfAnyDepthAreHeldWithoutASliverTolerance) {
  for (int k = 4; k <= 17; ++k) {
    const double d = 0.37 * std::pow(10.0, -k);
    write_bytes(folder / "skin.stl", ascii_stl(box_mesh({-d, 0, 0}, {4 + d, 3 + d, 3})));
    for (const char* degree : {"1", "2", "3"})
      for (const char* tolerance : {"0", "1e-16", "1e-9"}) {
        const auto r = json({"skin.stl", "-o", "a.h5", "--force", "--box", "-2", "-2", "-2", "6", "5", "5", "--spans",
                             "8", "7", "7", "--degree", degree, "--sliver-tolerance", tolerance});
        EXPECT_NEAR(number(r, "volume"), (4 + 2 * d) * (3 + d) * 3, 3e-8) << d << " " << degree << " " << tolerance;
        EXPECT_LE(number(r, "max_residual"), 1e-10);
      }
  }
}

// The rows of spans run along x: a face missing across them shows in their volumes, one beside them in no volume at
// all.
TEST_F(Igaprep, AcceptsASurfaceThatIsOpenOnAnySide) {
  for (std::size_t face = 0; face < 6; ++face) {
    TriangleMesh open = box_mesh({0, 0, 0}, {10, 8, 6});
    const auto first = open.triangles.begin() + static_cast<std::ptrdiff_t>(2 * face);
    open.triangles.erase(first, first + 2);
    write_bytes(folder / "open.stl", ascii_stl(open));
    EXPECT_EQ(run({"open.stl", "-o", "a.h5", "--force", "--spans", "5"}).exit_code, 2);
    const ProgramRun accepted = run({"open.stl", "-o", "a.h5", "--force", "--spans", "5", "--accept-leaks"});
    EXPECT_TRUE(accepted.exit_code == 0 || accepted.exit_code == 2 || accepted.exit_code == 4) << face << accepted.err;
    EXPECT_NE(accepted.err.find("open"), std::string::npos) << face << accepted.err;
  }
}

TEST_F(Igaprep, QuietPrintsNothingOnSuccess) {
  const ProgramRun done = run({"cube.stl", "--span-size", "20", "--quiet"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(done.err, "");
}

TEST_F(Igaprep, PrintsPlainLinesIntoAPipe) {
  const ProgramRun done = run({"cube.stl", "--span-size", "20"});
  EXPECT_NE(done.err.find("quadrature"), std::string::npos);
  EXPECT_EQ(done.err.find('\r'), std::string::npos);
  EXPECT_EQ(done.err.find('\033'), std::string::npos);
}

TEST_F(Igaprep, HelpShowsExamplesAndVersionItsNumber) {
  const ProgramRun help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* word : {"Examples:", "--span-size", "--moment-degree", "Exit codes"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
  const ProgramRun version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("igaprep ", 0), 0U) << version.out;
}

struct Interrupted : Igaprep, testing::WithParamInterface<int> {};

TEST_P(Interrupted, LeavesTheOldFileAndNothingElse) {
  write_bytes(folder / "cube.h5", "the old file");
  options.signal_after = "trim";
  options.signal = GetParam();
  // Fine enough that the work lasts until the signal arrives.
  const ProgramRun done =
      run({"cube.stl", "--spans", "150", "--rotate-axis-angle", "1", "2", "3", "20", "--degree", "3", "--force"});
  EXPECT_EQ(done.exit_code, 128 + GetParam()) << done.err;
  EXPECT_EQ(entries(folder.path()), (std::vector<std::string>{"cube.h5", "cube.stl"}));
  EXPECT_EQ(read_bytes(folder / "cube.h5"), "the old file");
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupted, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

// Points being reduced are no reason to lose the rules there are.
TEST_P(Interrupted, WhileReducingWritesTheRulesThereAre) {
  options.signal_after = "reduction";
  options.signal = GetParam();
  const std::vector<std::string> arguments{"cube.stl", "--spans",  "40", "--rotate-axis-angle", "1",      "2", "3",
                                           "20",       "--degree", "3",  "--trimmed",           "minimal"};
  const ProgramRun done = run(arguments);
  EXPECT_EQ(done.exit_code, 128 + GetParam()) << done.err;
  EXPECT_NE(done.err.find("keep their nnls rule"), std::string::npos) << done.err;
  EXPECT_NE(done.err.find("--force"), std::string::npos) << done.err;
  const TrimmedModel model = io::read_model(folder / "cube.h5");
  EXPECT_TRUE(check(model).empty());
  EXPECT_LE(model.quadrature.max_residual, 1e-10);
  options.signal_after.reset();
  const ProgramRun again = run(arguments);
  EXPECT_EQ(again.exit_code, 2) << again.err; // it is not the file that these settings make
}

TEST_F(Igaprep, MinimalRulesAndGeneralisedOnesSaveMostPoints) {
  const auto full = json({"cube.stl", "-o", "full.h5", "--spans", "10", "--rotate-axis-angle", "1", "2", "3", "20",
                          "--quadrature", "gauss", "--trimmed", "nnls"});
  const auto few = json({"cube.stl", "-o", "few.h5", "--spans", "10", "--rotate-axis-angle", "1", "2", "3", "20",
                         "--quadrature", "ggq-reduced", "--trimmed", "minimal"});
  EXPECT_LT(number(few, "points_trimmed"), 0.4 * number(full, "points_trimmed"));
  EXPECT_LT(number(few, "points_interior"), 0.3 * number(full, "points_interior"));
  EXPECT_NEAR(number(few, "volume"), number(full, "volume"), 1e-9 * number(full, "volume"));
  EXPECT_GT(number(few, "removed_by_newton"), 1000);
  EXPECT_EQ(io::read_model(folder / "few.h5").quadrature.trimmed_rule, "minimal");
  EXPECT_EQ(io::read_model(folder / "few.h5").quadrature.interior_rule, "ggq-reduced");
}

TEST_F(Igaprep, KilledHardKeepsTheOldFile) {
  write_bytes(folder / "cube.h5", "the old file");
  options.signal_after = "write";
  options.signal = SIGKILL;
  const ProgramRun done = run({"cube.stl", "--spans", "40", "--force"});
  // The kill may come a moment late: then the new file is whole.
  const bool finished = done.exit_code == 0;
  EXPECT_TRUE(finished || done.exit_code == 128 + SIGKILL);
  const std::string now = read_bytes(folder / "cube.h5");
  if (now == "the old file") return;
  options = {};
  options.folder = folder.path();
  EXPECT_EQ(json({"cube.stl", "--spans", "40"}).at("reused"), "true");
}

} // namespace
} // namespace iga::test
