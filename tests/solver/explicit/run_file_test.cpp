// The run file of `igasolve explicit`: what is read, what is refused and with which words; restart files give back
// every bit.
#include "solver/explicit/run/run_file.hpp"

#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/explicit/run/run_restart.hpp"
#include "solver/explicit/run/run_scene.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/temp_folder.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace iga::solve {
namespace {

const std::string good = R"(gravity = [0, 0, -9.81e-3]
[[bodies]]
name = "cube"
model = "cube.h5"
mass = "two-pass"
light_functions = "none"
damping = 0.1
velocity = [1, 2, 3]
edge_length = 0.5
material = { law = "neo-hookean", E = 1, nu = 0.3, rho = 2 }
[[bodies]]
name = "pin"
model = "pin.h5"
material = { law = "linear-elastic", E = 2, nu = 0.2, rho = 3 }
[[rigid_bodies]]
name = "ball"
shape = "sphere"
radius = 3
centre = [1, 2, 3]
motion = "free"
mass = 5
inertia = [1, 2, 2.5]
velocity = [0, 0, -8]
guided = "xy"
[[rigid_bodies]]
name = "press"
shape = "plane"
centre = [0, 0, 9]
normal = [0, 0, -2]
[rigid_bodies.drive]
kind = "velocity"
z = "press.csv"
[[contacts]]
bodies = ["ball", "cube"]
friction = 0.3
friction_dynamic = 0.2
friction_decay = 4
stiffness = 0.2
damping = 0.1
[[contacts]]
name = "own"
self = "cube"
[[loads]]
body = "pin"
region = 0
pressure = 2
follows = true
factor = [[0, 0], [1, 3]]
[[supports]]
body = "cube"
whole_surface = true
fixed = "x"
[supports.drive]
z = [[0, 0], [2, 1]]
smooth = true
[[stop]]
quantity = "energy/kinetic"
below = 1e-3
after = 2
[time]
end = 8
safety = 0.8
dt_max = 0.5
dt_min = 1e-6
[energy]
limit = 0.3
[output]
interval = 0.1
restart_interval = 1
)";

class RunFile : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* file : {"cube.h5", "pin.h5"}) test::write_bytes(folder_ / file, "not looked into yet");
    test::write_bytes(folder_ / "press.csv", "time,velocity\n0,0\n1,-2\n");
  }
  ExplicitRun read(const std::string& text) {
    test::write_bytes(folder_ / "run.toml", text);
    return read_explicit_run(folder_ / "run.toml");
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  test::TempFolder folder_;
};

TEST_F(RunFile, SaysWhatIsWanted) {
  const ExplicitRun run = read(good);
  ASSERT_EQ(run.bodies.size(), 2u);
  const BodyRun& cube = run.bodies[0];
  EXPECT_EQ(cube.model, folder_ / "cube.h5");
  EXPECT_EQ(cube.body.name, "cube");
  EXPECT_EQ(cube.body.mass, MassType::TwoPass);
  EXPECT_EQ(cube.body.light.remedy, LightFunctions::None);
  EXPECT_EQ(cube.body.damping, 0.1);
  EXPECT_EQ(cube.body.acceleration, (Point3{0, 0, -9.81e-3}));
  EXPECT_EQ(cube.velocity, (Point3{1, 2, 3}));
  EXPECT_EQ(cube.edge_length, 0.5);
  EXPECT_EQ(cube.material.name, "neo-hookean");
  EXPECT_EQ(run.bodies[1].body.light.remedy, LightFunctions::Linear);

  ASSERT_EQ(run.rigid.size(), 2u);
  const auto& free = std::get<FreeMotion>(run.rigid[0].body.motion);
  EXPECT_EQ(free.mass, 5);
  EXPECT_EQ(free.inertia[2][2], 2.5);
  EXPECT_EQ(free.velocity, (Point3{0, 0, -8}));
  EXPECT_EQ(free.acceleration, (Point3{0, 0, -9.81e-3}));
  EXPECT_EQ(free.guided, (std::array{true, true, false}));
  EXPECT_EQ(std::get<PlaneShape>(run.rigid[1].body.shape).normal, (Point3{0, 0, -1}));
  const auto& driven = std::get<PrescribedMotion>(run.rigid[1].body.motion);
  EXPECT_TRUE(driven.curves_are_velocities);
  ASSERT_TRUE(driven.translation[2].has_value());
  EXPECT_EQ(driven.translation[2]->value(0.5), -1);
  EXPECT_FALSE(driven.translation[0].has_value());

  ASSERT_EQ(run.contacts.size(), 2u);
  EXPECT_EQ(run.contacts[0].pair.name, "ball-cube");
  EXPECT_TRUE(run.contacts[0].swapped);
  EXPECT_EQ(run.contacts[0].pair.first.kind, ContactSide::Kind::Deformable);
  EXPECT_EQ(run.contacts[0].pair.second.kind, ContactSide::Kind::Rigid);
  EXPECT_EQ(run.contacts[0].pair.friction.static_coefficient, 0.3);
  EXPECT_EQ(run.contacts[0].pair.friction.dynamic_coefficient, 0.2);
  EXPECT_EQ(run.contacts[0].pair.friction.decay, 4);
  EXPECT_EQ(run.contacts[0].pair.stiffness, 0.2);
  EXPECT_EQ(run.contacts[1].pair.name, "own");
  EXPECT_EQ(run.contacts[1].pair.first.number, run.contacts[1].pair.second.number);

  ASSERT_EQ(run.loads.size(), 1u);
  EXPECT_EQ(run.loads[0].body, 1u);
  EXPECT_TRUE(run.loads[0].load.follows);
  EXPECT_EQ(run.loads[0].load.factor.value(0.5), 1.5);
  ASSERT_EQ(run.supports.size(), 1u);
  EXPECT_TRUE(run.supports[0].region.motion[0].has_value());
  EXPECT_FALSE(run.supports[0].region.motion[1].has_value());
  EXPECT_EQ(run.supports[0].region.motion[2]->value(1), 0.5);
  ASSERT_EQ(run.stops.size(), 1u);
  EXPECT_FALSE(run.stops[0].above);
  EXPECT_EQ(run.time.end_time, 8);
  EXPECT_EQ(run.time.safety, 0.8);
  EXPECT_EQ(run.time.energy_limit, 0.3);
  EXPECT_EQ(run.smallest_dt, 1e-6);
  EXPECT_EQ(run.out.interval, 0.1);
  EXPECT_EQ(run.out.field_interval, 8.0 / 50);
  EXPECT_EQ(run.inputs.size(), 3u); // two models, a curve
}

TEST_F(RunFile, LockingOfABody) {
  EXPECT_FALSE(read(good).bodies[0].body.kernel.mean_volume);
  for (const bool fbar : {false, true}) {
    std::string text = good;
    text.replace(text.find("edge_length = 0.5"), 17, fbar ? "locking = \"fbar\"" : "locking = \"none\"");
    EXPECT_EQ(read(text).bodies[0].body.kernel.mean_volume, fbar);
  }
}

TEST_F(RunFile, PlacesBodies) {
  std::string text = good;
  const std::string old = "edge_length = 0.5";
  text.replace(text.find(old), old.size(),
               "place = { axis = [0, 0, 2], degrees = 90, about = [1, 0, 0], shift = [0, 0, 5] }");
  const ExplicitRun run = read(text);
  const Point3 x = run.bodies[0].place.moved({3, 0, 1});
  EXPECT_NEAR(x[0], 1, 1e-15);
  EXPECT_NEAR(x[1], 2, 1e-15);
  EXPECT_EQ(x[2], 6);
  EXPECT_EQ(run.bodies[1].place, Placement{});
  text = good;
  text.replace(text.find(old), old.size(), "place = { degrees = 90 }");
  EXPECT_NE(error_of(text).find("needs both axis"), std::string::npos);
  text = good;
  text.replace(text.find(old), old.size(), "place = { shfit = [0, 0, 1] }");
  EXPECT_NE(error_of(text).find("did you mean 'shift'"), std::string::npos) << error_of(text);
}

struct Wrong {
  const char *from, *to; ///< change of the good file
  std::vector<const char*> words;
};

TEST_F(RunFile, WrongSettingsAreRefusedWithTheirPlace) {
  const std::vector<Wrong> cases{
      {"model = \"cube.h5\"", "", {"run.toml:2:", "'model'", "missing"}},
      {"\"cube.h5\"", "\"none.h5\"", {"run.toml:4:", "none.h5"}},
      {"rho = 2 }", "rho = -2 }", {"run.toml:10:", "rho"}},
      {"rho = 2 }", "roh = 2 }", {"run.toml:10:", "unknown key 'roh'", "did you mean 'rho'"}},
      {"damping = 0.1\nvel", "damping = -1\nvel", {"run.toml:7:", "found -1"}},
      {"\"two-pass\"", "\"twopass\"", {"run.toml:5:", "did you mean two-pass?"}},
      {"damping = 0.1\nvel", "locking = \"fba\"\nvel", {"run.toml:7:", "did you mean fbar?"}},
      {"model = \"pin.h5\"", "model = \"pin.h5\"\nlocking = \"fbar\"", {"run.toml:14:", "take neo-hookean"}},
      {"name = \"pin\"", "name = \"cube\"", {"run.toml:12:", "another body 'cube'"}},
      {"name = \"ball\"", "name = \"cube\"", {"run.toml:16:", "another body 'cube'"}},
      {"name = \"ball\"", "name = \"a/b\"", {"run.toml:16:", "without slashes"}},
      {"\"sphere\"", "\"shpere\"", {"run.toml:17:", "did you mean sphere?"}},
      {"radius = 3", "radius = -3", {"run.toml:18:", "above 0"}},
      {"radius = 3", "radius = 3\nheight = 1", {"run.toml:19:", "a sphere has none"}},
      {"mass = 5", "mass = -5", {"run.toml:21:", "found -5"}},
      {"mass = 5", "", {"'mass'", "missing"}},
      {"[1, 2, 2.5]", "[1, 2, 9]", {"run.toml:17:", "belong to no body"}},
      {"guided = \"xy\"", "guided = \"q\"", {"run.toml:24:", "x, y, z"}},
      {"motion = \"free\"", "", {"a fixed body has none"}},
      {"\"press.csv\"", "\"lost.csv\"", {"run.toml:32:", "lost.csv"}},
      {"z = \"press.csv\"", "z = [[1, 0], [0, 0]]", {"run.toml:32:", "'z'"}},
      {"z = \"press.csv\"", "z = [[1, 0], [2]]", {"run.toml:32:", "2 finite numbers"}},
      {"[\"ball\", \"cube\"]", "[\"ball\", \"cub\"]", {"run.toml:34:", "did you mean cube?"}},
      {"[\"ball\", \"cube\"]", "[\"ball\", \"press\"]", {"run.toml:34:", "both are rigid"}},
      {"[\"ball\", \"cube\"]", "[\"ball\"]", {"run.toml:34:", "expected two"}},
      {"friction_dynamic = 0.2", "friction_dynamic = 0.4", {"run.toml:36:", "no more than the static"}},
      {"stiffness = 0.2", "stifness = 0.2", {"run.toml:38:", "unknown key", "'stiffness' in [contacts]"}},
      {"self = \"cube\"", "self = \"ball\"", {"cannot touch itself"}},
      {"name = \"own\"", "name = \"ball-cube\"", {"another contact"}},
      {"body = \"pin\"\n", "", {"several bodies"}},
      {"pressure = 2\n", "", {"no value"}},
      {"pressure = 2\n", "traction = [1, 0, 0]\n", {"only a pressure follows"}},
      {"region = 0\n", "", {"'region' in [loads]", "missing"}},
      {"fixed = \"x\"", "fixed = \"z\"", {"z is driven"}},
      {"whole_surface = true\n", "", {"'region' in [supports]"}},
      {"below = 1e-3", "below = 1e-3\nabove = 1", {"either above or below"}},
      {"end = 8", "end = 0", {"'end' in [time]", "above 0"}},
      {"end = 8", "ende = 8", {"unknown key 'ende' in [time]", "did you mean 'end'"}},
      {"safety = 0.8", "safety = 1.5", {"at most 1"}},
      {"dt_min = 1e-6", "dt_min = 1e-6\nstart_share = 1.1", {"expected at most 1"}},
      {"dt_min = 1e-6", "dt_min = 0.6", {"less than dt_max"}},
      {"limit = 0.3", "limits = 0.3", {"unknown key", "'limit' in [energy]"}},
      {"interval = 0.1\n", "interval = 1e-9\n", {"more than 1e+06"}},
      {"[time]", "[tiem]", {"unknown key 'tiem'", "did you mean 'time'?"}},
  };
  for (const Wrong& wrong : cases) {
    std::string text = good;
    const auto at = text.find(wrong.from);
    ASSERT_NE(at, std::string::npos) << wrong.from;
    text.replace(at, std::string(wrong.from).size(), wrong.to);
    const std::string error = error_of(text);
    EXPECT_NE(error.find("run.toml"), std::string::npos) << error;
    for (const char* word : wrong.words)
      EXPECT_NE(error.find(word), std::string::npos) << wrong.to << "\n  " << error << "\n  lacks: " << word;
  }
  EXPECT_NE(error_of("[time]\nend = 1\n").find("at least one [[bodies]]"), std::string::npos);
}

// Names of materials, and places that loads of static runs act on, in an explicit run.
TEST_F(RunFile, TakesNamedMaterialsAndLoadsOnPlaces) {
  TrimmedModel model = test::make_box_model(); // in mm, 1.25 … 4.75, 1.5 … 3.5, 1 … 2.6
  test::add_places(model);                     // "edge 1" along two edges of its foot
  io::write_model(folder_ / "box.h5", model);
  const std::string body = "[[bodies]]\nmodel = \"box.h5\"\n", time = "[time]\nend = 1\n";
  const std::string steel = "material = { name = \"steel\", law = \"linear-elastic\" }\n";
  const std::string loads = "[[loads]]\ncurve = \"edge 1\"\nforce = [1, 2, 3]\n"
                            "[[loads]]\nregion = \"u+\"\nmoment = [0, 0, 1]\n";
  const ExplicitRun run = read("unit_system = \"kg-mm-ms\"\n" + body + steel + loads + time);
  EXPECT_EQ(run.bodies[0].material.name, "linear-elastic");
  EXPECT_NEAR(small_strain(run.bodies[0].material.law).density, 7.85e-6, 1e-18);
  EXPECT_NEAR(small_strain(run.bodies[0].material.law).C(3, 3), 210 / 2.6, 1e-9);
  const ExplicitScene scene(run);
  ASSERT_EQ(scene.loads().size(), 2u);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(scene.loads()[0].force[d], static_cast<double>(d + 1), 1e-12);
    EXPECT_NEAR(scene.loads()[1].force[d], 0, 1e-12);
    EXPECT_NEAR(scene.loads()[1].moment[d], d == 2 ? 1 : 0, 1e-12);
  }
  const auto has = [](const std::vector<std::string>& texts, const char* words) {
    return std::any_of(texts.begin(), texts.end(), [&](const auto& t) { return t.find(words) != std::string::npos; });
  };
  EXPECT_TRUE(has(scene.findings(), "steel: E = 210 GPa, nu = 0.3, rho = 7.85e-06 kg/mm³"));
  EXPECT_TRUE(has(scene.findings(), "the part has a mass of 8.792e-05 kg")); // 11.2 mm³
  EXPECT_TRUE(has(scene.warnings(), "load 'load 1' acts along a line"));

  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string error = error_of(text);
    for (const std::string& word : words) EXPECT_NE(error.find(word), std::string::npos) << word << " in: " << error;
  };
  refused(body + "material = { name = \"stele\" }\n" + time, {"run.toml:3", "'name'", "did you mean \"steel\""});
  refused("unit_system = \"SI\"\n" + body + steel + time, {"run.toml:4", "lengths in m", "box.h5"});
  refused(
      body +
          "material = { name = \"steel\", law = \"linear-elastic\", C = [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, "
          "1, 0, 0, 1, 0, 1] }\n" +
          time,
      {"run.toml:3", "matrix C"});
  const ExplicitRun rigid =
      read(body + steel + "[[loads]]\nregion = \"u+\"\nforce = [1, 0, 0]\nspread = \"rigid\"\n" + time);
  try {
    const ExplicitScene no(rigid);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no region rigid"), std::string::npos) << error.what();
  }
}

// Each table in turn gets a key that it does not have, and loses everything else: the key is what is said.
TEST_F(RunFile, AWrongKeyIsNamedBeforeAnythingElseIsSaidOfItsTable) {
  for (const std::string table :
       {"[[bodies]]", "[bodies.material]", "[bodies.place]", "[[rigid_bodies]]", "[rigid_bodies.drive]", "[contact]",
        "[[contacts]]", "[[loads]]", "[loads.plane]", "[loads.normal]", "[[supports]]", "[supports.drive]", "[time]",
        "[energy]", "[output]", "[[stop]]"}) {
    std::string parents;
    if (const auto dot = table.find('.'); dot != std::string::npos) parents = "[[" + table.substr(1, dot - 1) + "]]\n";
    const std::string error = error_of(parents + table + "\ntemperature = \"hot\"\n");
    EXPECT_NE(error.find("run.toml:" + std::to_string(parents.empty() ? 2 : 3) + ": unknown key 'temperature'"),
              std::string::npos)
        << table << ": " << error;
  }
  // The first of several, by line; a value that is wrong as well comes second.
  const std::string error = error_of("[[bodies]]\nmass = 7\nmodell = 1\n[[stop]]\nbelow = 1\nabov = 2\n");
  EXPECT_NE(error.find("run.toml:3: unknown key 'modell' in [bodies]; did you mean 'model'"), std::string::npos)
      << error;
}

RestartState some_state() {
  RestartState r;
  r.version = "1.2.3";
  r.inputs = {{"run.toml", "aa"}, {"cube.h5", "bbbbbbbbbbbb"}};
  r.settings = {{"bodies[1].edge_length", "4"}, {"bodies[1].model", "\"cube.h5\""}, {"time.end", "8"}};
  r.limits = {{3.5, 0.57, false, 12, 0.25}};
  r.state.bodies.resize(1);
  auto& body = r.state.bodies[0];
  body.name = "cube";
  body.displacement = {1.0 / 3, -0.0, 5e-324};
  body.velocity = {1, 2, 3};
  body.momentum = {4, 5, 6};
  body.points.history = {0.1, 0.2};
  body.momenta[17] = 0.7;
  body.report.min_J = 0.3;
  body.report.step_span = 7;
  body.inverted = 11;
  r.state.sources = {{"contact/numbers", {}, 0},
                     {"contact/density/cube", {std::numeric_limits<double>::max(), 4294967295.0}, 0}};
  r.state.progress.time = 0.1 + 0.2;
  r.state.progress.control.count = 9;
  r.state.progress.steps = 123456789;
  r.state.progress.open.viscous = 1e-300;
  r.state.progress.largest_energy = 8;
  r.sums = {1, 2, 3};
  r.rows = 5;
  return r;
}

TEST(RestartFile, GivesBackEveryBit) {
  const test::TempFolder folder;
  const RestartState r = some_state();
  write_restart(folder / "a.h5", r);
  const RestartState back = read_restart(folder / "a.h5");
  write_restart(folder / "b.h5", back);
  EXPECT_EQ(test::read_bytes(folder / "a.h5"), test::read_bytes(folder / "b.h5"));
  EXPECT_EQ(back.state.bodies[0].displacement, r.state.bodies[0].displacement);
  EXPECT_TRUE(std::signbit(back.state.bodies[0].displacement[1]));
  EXPECT_EQ(back.state.bodies[0].points.history, r.state.bodies[0].points.history);
  EXPECT_EQ(back.state.bodies[0].momenta, r.state.bodies[0].momenta);
  EXPECT_EQ(back.state.bodies[0].report.step_span, 7);
  EXPECT_EQ(back.state.bodies[0].inverted, 11);
  EXPECT_EQ(back.state.bodies[0].name, "cube");
  EXPECT_EQ(back.state.sources, r.state.sources);
  EXPECT_EQ(back.settings, r.settings);
  EXPECT_EQ(back.inputs.size(), 2u);
  EXPECT_EQ(back.state.progress.time, r.state.progress.time);
  EXPECT_EQ(back.state.progress.control.count, 9);
  EXPECT_EQ(back.state.progress.steps, 123456789);
  EXPECT_EQ(back.state.progress.open.viscous, 1e-300);
  EXPECT_EQ(back.limits[0].dt, 0.57);
  EXPECT_FALSE(back.limits[0].by_lanczos);
  EXPECT_EQ(back.sums, r.sums);
  EXPECT_EQ(back.rows, 5);
}

ExplicitRun some_run() {
  ExplicitRun run;
  run.file = "run.toml";
  run.settings = {{"bodies[1].edge_length", "4", 3}, {"bodies[1].model", "\"cube.h5\"", 4}, {"time.end", "8", 9}};
  run.inputs = {{"cube.h5", "run.toml:4: 'model' in [bodies]"}};
  run.bodies.resize(1);
  run.bodies[0].body.name = "cube";
  return run;
}

std::string refusal(const RestartState& r, const ExplicitRun& run, const std::vector<InputFile>& inputs) {
  try {
    check_restart(r, run, inputs, "r.h5", "1.2.3");
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(RestartFile, BelongsToItsFiles) {
  const RestartState r = some_state();
  auto inputs = r.inputs;
  inputs[0].sha256 = "cc"; // comments of the run file, and the order of its keys, may change
  EXPECT_TRUE(check_restart(r, some_run(), inputs, "r.h5", "1.2.3").empty());
  inputs[1].sha256 = "cccccccccccc";
  const std::string error = refusal(r, some_run(), inputs);
  EXPECT_NE(error.find("run.toml:4: 'model' in [bodies]: cube.h5 changed"), std::string::npos) << error;
  inputs.pop_back();
  EXPECT_NE(refusal(r, some_run(), inputs).find("/input_names: found 2 files, expected 1"), std::string::npos);
  RestartState other = r;
  other.state.bodies[0].name = "ball";
  EXPECT_NE(refusal(other, some_run(), r.inputs).find("/body_names: found ball, expected cube"), std::string::npos);
  RestartState old = r;
  old.version = "0.0.1";
  EXPECT_NE(refusal(old, some_run(), r.inputs).find("written by igasolve 0.0.1, this is 1.2.3"), std::string::npos);
}

TEST(RestartFile, NamesEachValueThatMayNotChange) {
  const RestartState r = some_state();
  ExplicitRun run = some_run();
  run.settings[0].value = "8";
  EXPECT_NE(refusal(r, run, r.inputs).find("run.toml:3: bodies[1].edge_length: 4 when the run began, 8 now"),
            std::string::npos)
      << refusal(r, run, r.inputs);
  run = some_run();
  run.settings.erase(run.settings.begin());
  EXPECT_NE(refusal(r, run, r.inputs).find("run.toml: bodies[1].edge_length: 4 when the run began, nothing now"),
            std::string::npos);
  for (const char* path : {"output.subdivide", "gravity", "contact.skin", "contacts[1].friction", "loads[2].pressure",
                           "supports[1].fixed", "rigid_bodies[1].mass", "units"}) {
    run = some_run();
    run.settings.push_back({path, "7", 12});
    EXPECT_NE(refusal(r, run, r.inputs).find(std::string("run.toml:12: ") + path + ": nothing when"), std::string::npos)
        << refusal(r, run, r.inputs);
  }
  for (const char* path : {"time.safety", "output.interval", "output.points", "energy.limit", "stop[1].above"}) {
    run = some_run();
    run.settings.push_back({path, "7", 12});
    run.settings[2].value = "9";
    const auto warnings = check_restart(r, run, r.inputs, "r.h5", "1.2.3");
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("time.end: 8 when the run began, 9 now"), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(path), std::string::npos) << warnings[0];
  }
}

} // namespace
} // namespace iga::solve
