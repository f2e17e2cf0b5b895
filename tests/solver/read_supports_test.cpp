// [[support]], [[load]] and [[probe]]: what a run file may say and what is refused, with its line.
#include "solver/supports/read_supports.hpp"

#include "format/model/errors.hpp"
#include "tests/support/temp_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

namespace {

class RunFile {
 public:
  explicit RunFile(const std::string& text) : path_(folder_.path() / "run.toml") { std::ofstream(path_) << text; }
  io::SettingsTable table() const { return io::SettingsTable::read(path_); }

  struct Read {
    std::vector<Support> supports;
    StaticSettings statics;
  };
  Read read() const {
    io::SettingsTable root = table();
    Read result{read_supports(root), read_static_settings(root)};
    root.refuse_unknown_keys();
    return result;
  }
  void expect_refused(const std::vector<std::string>& words) const {
    try {
      read();
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in: " << error.what();
    }
  }

 private:
  test::TempFolder folder_;
  std::filesystem::path path_;
};

} // namespace

TEST(RunFile, HoldsSupportsLoadsAndProbes) {
  const auto run = RunFile(R"(
[[support]]
name = "base"
region = "bottom"
box = [0, 0, 0, 1, 2, 3]
plane = { point = [0, 0, 1], normal = [0, 0, 1], tolerance = 0.5 }
normal = { direction = [0, 0, -1], angle = 20 }
fixed = "xz"
value = [1, 2, 3]
gradient = [1, 2, 3, 4, 5, 6, 7, 8, 9]
rotate_axis_angle = [0, 0, 2, 90]
method = "penalty"
penalty_factor = 50

[[support]]
region = 3
fixed = "normal"
value = 0.25

[[load]]
traction = [1, 2, 3]
whole_surface = true
[[load]]
pressure = 4
region = 2
[[load]]
force = [1, 0, 0]
at = [1, 2, 3]
[[load]]
force = [1, 0, 0]
region = "top"
[[load]]
body_force = [0, 0, -1]
[[load]]
acceleration = [0, 0, -9.81]

[[probe]]
position = [1, 2, 3]
)")
                       .read();
  ASSERT_EQ(run.supports.size(), 2u);
  const Support& base = run.supports[0];
  EXPECT_EQ(base.name, "base");
  EXPECT_EQ(base.region.names, std::vector<std::string>{"bottom"});
  EXPECT_EQ(base.region.box->upper, (Point3{1, 2, 3}));
  EXPECT_EQ(base.region.plane->tolerance, 0.5);
  EXPECT_EQ(base.region.normal->angle, 20);
  EXPECT_EQ(base.fixed, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(base.value, (Point3{1, 2, 3}));
  EXPECT_EQ(base.gradient[1], (Point3{4, 5, 6}));
  EXPECT_EQ(base.method, SupportMethod::Penalty);
  EXPECT_EQ(base.penalty_factor, 50);
  const Rotation quarter{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}; // its first axis is y
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(base.frame[r][c], quarter[r][c], 1e-15);
  EXPECT_TRUE(run.supports[1].along_normal);
  EXPECT_EQ(run.supports[1].region.numbers, std::vector<std::int64_t>{3});
  EXPECT_EQ(run.supports[1].value[0], 0.25);
  EXPECT_EQ(run.supports[1].name, "support 2");
  EXPECT_EQ(run.supports[1].method, SupportMethod::Nitsche);
  const std::vector<LoadKind> kinds{LoadKind::Traction,   LoadKind::Pressure,  LoadKind::Point,
                                    LoadKind::TotalForce, LoadKind::BodyForce, LoadKind::Acceleration};
  ASSERT_EQ(run.statics.loads.size(), kinds.size());
  for (std::size_t k = 0; k < kinds.size(); ++k) EXPECT_EQ(run.statics.loads[k].kind, kinds[k]);
  EXPECT_EQ(run.statics.loads[2].place.at, (Point3{1, 2, 3}));
  EXPECT_EQ(run.statics.probes[0].name, "probe 1");
}

TEST(RunFile, HoldsLinesPointsPatchesAndCylinders) {
  const auto run = RunFile(R"(
[[support]]
curve = "edge 12"
fixed = "z"
[[support]]
curve = ["edge 1", "edge 2"]
[[support]]
line = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
penalty_factor = 10
[[support]]
point = "vertex 3"
[[support]]
at = [1, 2, 3]
[[support]]
patch = "heads.stl"
[[support]]
patch = { file = "heads.stl", tolerance = 0.5 }
region = "top"
[[support]]
region = "bore"
fixed = "pinned"
value = 0.1
[[support]]
region = "bore"
fixed = "radial"
method = "penalty"

[[load]]
curve = "edge 1"
force = [1, 0, 0]
[[load]]
point = "vertex 1"
force = [1, 0, 0]
[[load]]
region = "bore"
bearing = [1, 2, 0]
[[load]]
region = "top"
force = [1, 0, 0]
moment = [0, 1, 0]
remote = [5, 5, 5]
spread = "rigid"
[[load]]
region = "top"
moment = [0, 1, 0]
[[load]]
region = "top"
force = [1, 0, 0]
remote = [5, 5, 5]
spread = "even"
)")
                       .read();
  ASSERT_EQ(run.supports.size(), 9u);
  EXPECT_EQ(run.supports[0].place.curves, std::vector<std::string>{"edge 12"});
  EXPECT_EQ(run.supports[0].method, SupportMethod::Penalty);
  EXPECT_EQ(run.supports[1].place.curves.size(), 2u);
  EXPECT_EQ(run.supports[2].place.line[2], (Point3{1, 1, 0}));
  EXPECT_EQ(run.supports[2].penalty_factor, 10);
  EXPECT_EQ(run.supports[3].place.marker, "vertex 3");
  EXPECT_EQ(run.supports[4].place.at, (Point3{1, 2, 3}));
  EXPECT_EQ(run.supports[5].region.patch->file.filename(), "heads.stl");
  EXPECT_TRUE(run.supports[5].region.patch->file.is_absolute()); // beside the run file
  EXPECT_EQ(run.supports[5].region.patch->tolerance, std::nullopt);
  EXPECT_EQ(run.supports[6].region.patch->tolerance, 0.5);
  EXPECT_TRUE(run.supports[7].radial && run.supports[7].axial);
  EXPECT_EQ(run.supports[7].value[0], 0.1);
  EXPECT_TRUE(run.supports[8].radial && !run.supports[8].axial);
  const std::vector<LoadKind> kinds{LoadKind::Line,   LoadKind::Point,  LoadKind::Bearing,
                                    LoadKind::Remote, LoadKind::Remote, LoadKind::Remote};
  const auto& loads = run.statics.loads;
  ASSERT_EQ(loads.size(), kinds.size());
  for (std::size_t k = 0; k < kinds.size(); ++k) EXPECT_EQ(loads[k].kind, kinds[k]);
  EXPECT_EQ(loads[1].place.marker, "vertex 1");
  EXPECT_EQ(loads[3].moment, (Point3{0, 1, 0}));
  EXPECT_EQ(loads[3].remote, (Point3{5, 5, 5}));
  EXPECT_TRUE(loads[3].rigid);
  EXPECT_EQ(loads[4].vector, Point3{});
  EXPECT_EQ(loads[4].remote, std::nullopt);
  EXPECT_FALSE(loads[5].rigid);
}

TEST(RunFile, RefusesLinesPointsPatchesAndCylindersThatMakeNoSense) {
  const std::string line = "[[support]]\nline = [[0, 0, 0], [1, 0, 0]]\n";
  RunFile(line + "region = 1\n").expect_refused({"run.toml:3", "given together with a choice of surface"});
  RunFile(line + "at = [0, 0, 0]\n").expect_refused({"run.toml:3", "'at'", "given together with line"});
  RunFile(line + "fixed = \"normal\"\n").expect_refused({"run.toml:3", "no \"normal\" direction"});
  RunFile(line + "fixed = \"pinned\"\n").expect_refused({"run.toml:3", "no \"pinned\" direction"});
  RunFile(line + "method = \"nitsche\"\n").expect_refused({"run.toml:3", "\"penalty\" alone"});
  RunFile("[[support]]\nline = [[0, 0, 0]]\n").expect_refused({"run.toml:2", "found 1 point"});
  RunFile("[[support]]\nline = [[0, 0], [1, 1]]\n").expect_refused({"run.toml:2", "lists of 3 finite numbers"});
  RunFile("[[support]]\ncurve = []\n").expect_refused({"run.toml:2", "the list is empty"});
  RunFile("[[support]]\ncurve = 3\n").expect_refused({"run.toml:2", "the integer 3"});
  RunFile("[[support]]\npoint = \"\"\n").expect_refused({"run.toml:2", "the name is empty"});
  const std::string bore = "[[support]]\nregion = \"bore\"\nfixed = \"pinned\"\n";
  RunFile(bore + "method = \"lagrange\"\n").expect_refused({"run.toml:4", "nitsche", "penalty"});
  RunFile(bore + "gradient = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n").expect_refused({"run.toml:4", "one number"});
  RunFile(bore + "value = [1, 2, 3]\n").expect_refused({"run.toml:4", "'value'"});
  RunFile("[[support]]\npatch = { tolerance = 1 }\n").expect_refused({"run.toml:2", "'file' in [support.patch]"});
  RunFile("[[support]]\npatch = { file = \"a.stl\", tolerance = -1 }\n").expect_refused({"run.toml:2", "0 or more"});
  RunFile("[[support]]\npatch = 3\n").expect_refused({"run.toml:2", "the integer 3"});
  const std::string load = "[[load]]\nregion = 1\n";
  RunFile(load + "pressure = 1\nmoment = [1, 0, 0]\n").expect_refused({"run.toml:4", "'moment'", "only a force"});
  RunFile(load + "traction = [1, 0, 0]\nremote = [1, 0, 0]\n").expect_refused({"run.toml:4", "'remote'"});
  RunFile(load + "force = [1, 0, 0]\nspread = \"rigit\"\n").expect_refused({"run.toml:4", "\"rigit\"", "\"rigid\""});
  RunFile(load + "spread = \"even\"\n").expect_refused({"no value"});
  RunFile(load + "bearing = [1, 0, 0]\nforce = [1, 0, 0]\n").expect_refused({"more than one value"});
  RunFile("[[load]]\nmoment = [1, 0, 0]\n").expect_refused({"run.toml:1", "'region'", "missing"});
  RunFile("[[load]]\nbearing = [1, 0, 0]\nat = [0, 0, 0]\n").expect_refused({"run.toml:3", "only a force acts"});
  RunFile("[[load]]\nforce = [1, 0, 0]\nmoment = [1, 0, 0]\nat = [0, 0, 0]\n")
      .expect_refused({"run.toml:3", "'moment'", "a force alone"});
  RunFile("[[load]]\nforce = [1, 0, 0]\n").expect_refused({"run.toml:1", "line", "at = [x, y, z]"});
}

TEST(RunFile, RefusesWhatMakesNoSenseWithItsLine) {
  const std::string head = "[[support]]\nregion = 1\n";
  RunFile(head + "fixd = \"xy\"\n").expect_refused({"run.toml:3", "'fixd' in [support]", "did you mean 'fixed'"});
  RunFile(head + "[[support]]\nregion = 1\nregoin = 2\n").expect_refused({"run.toml:5", "'regoin'", "'region'"});
  RunFile(head + "plane = { pont = [0, 0, 0] }\n").expect_refused({"run.toml:3", "'pont' in [support.plane]"});
  RunFile(head + "fixed = \"xx\"\n").expect_refused({"run.toml:3", "\"xx\"", "each once"});
  RunFile(head + "method = \"nitche\"\n").expect_refused({"run.toml:3", "did you mean nitsche"});
  RunFile(head + "penalty_factor = 3\n").expect_refused({"run.toml:3", "nitsche has none"});
  RunFile(head + "rotation = [1, 0, 0, 0, 2, 0, 0, 0, 1]\n").expect_refused({"run.toml:3", "orthogonal"});
  RunFile(head + "box = [0, 0, 0, 1, -1, 1]\n").expect_refused({"run.toml:3", "along y"});
  RunFile(head + "plane = { point = [0, 0, 0] }\n")
      .expect_refused({"run.toml:3", "'normal' in [support.plane]", "missing"});
  RunFile(head + "whole_surface = true\n").expect_refused({"run.toml:3", "one of them"});
  RunFile("[[support]]\nfixed = \"x\"\n").expect_refused({"run.toml:1", "'region'", "whole_surface"});
  RunFile("[support]\nregion = 1\n").expect_refused({"run.toml:1", "found a table", "[[support]]"});
  RunFile("[[load]]\nregion = 1\n").expect_refused({"run.toml:1", "no value"});
  RunFile("[[load]]\npressure = 1\n").expect_refused({"run.toml:1", "'region'", "missing"});
  RunFile("[[load]]\npressure = 1\ntraction = [1, 0, 0]\nregion = 1\n").expect_refused({"more than one value"});
  RunFile("[[load]]\ntraction = [1, 0, 0]\nat = [0, 0, 0]\nregion = 1\n").expect_refused({"run.toml:3", "'at'"});
  RunFile("[[load]]\nbody_force = [1, 0, 0]\nregion = 1\n").expect_refused({"run.toml:3", "acts on no surface"});
  RunFile("[[probe]]\nname = \"tip\"\n").expect_refused({"run.toml:1", "'position' in [probe]", "missing"});
  RunFile("probe = 3\n").expect_refused({"run.toml:1", "found the integer 3", "[[probe]]"});
}
