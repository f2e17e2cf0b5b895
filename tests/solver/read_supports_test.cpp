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
