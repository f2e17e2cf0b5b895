// igasolve as a user runs it: modes, time step and statics from a model file, and what it says to bad input.
#include "format/io/trimmed_model_io.hpp"
#include "tests/pipeline/json_text.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/temp_folder.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <unistd.h>

namespace iga::test {
namespace {

// A unit cube in spans of a third, its corner inside a span.
BoxCase a_cube() {
  const double h = 1.0 / 3;
  return {{0, 0, 0},         {8 * h, 8 * h, 8 * h}, {8, 8, 8},       {2, 2, 2},
          identity_rotation, {0.8, 0.9, 0.85},      {1.8, 1.9, 1.85}};
}

const std::vector<std::string> material{"--E", "1", "--nu", "0.3", "--rho", "1"};

struct Igasolve : testing::Test {
  TempFolder folder;
  RunOptions options;
  void SetUp() override {
    options.folder = folder.path();
    io::write_model(folder / "cube.h5", make_box_model(a_cube()));
  }
  ProgramRun run(std::vector<std::string> arguments, bool with_material = true) {
    if (with_material) arguments.insert(arguments.end(), material.begin(), material.end());
    return run_program(IGASOLVE, arguments, options);
  }
  std::map<std::string, std::string> json(std::vector<std::string> arguments, bool with_material = true) {
    arguments.emplace_back("--json");
    const ProgramRun r = run(std::move(arguments), with_material);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return r.exit_code == 0 ? parse_json(r.out) : std::map<std::string, std::string>{};
  }
};

double number(const std::map<std::string, std::string>& report, const std::string& key) {
  const auto it = report.find(key);
  return it == report.end() ? std::nan("") : std::stod(it->second);
}

TEST_F(Igasolve, FindsTheModesOfAFreeCube) {
  const auto r = json({"eigen", "cube.h5", "--modes", "8"});
  EXPECT_EQ(number(r, "rigid_modes"), 6);
  EXPECT_EQ(number(r, "mechanisms"), 0);
  EXPECT_EQ(number(r, "bodies"), 1);
  EXPECT_EQ(number(r, "sturm.expected"), number(r, "sturm.found"));
  EXPECT_NEAR(number(r, "mass"), 1, 1e-11);
  // ω L √(ρ/E) of the free cube, nu = 0.3 (Demarest 1971): 2, 3, 3 equal modes; h = L/3 is coarse and too stiff
  const double expected[] = {1.771244, 1.771244, 2.385170, 2.385170, 2.385170, 2.425655, 2.425655, 2.425655};
  for (int m = 0; m < 8; ++m) {
    const double omega = 2 * std::numbers::pi * number(r, "frequencies." + std::to_string(6 + m));
    EXPECT_GT(omega, expected[m] * (1 - 1e-4)) << m;
    EXPECT_LT(omega, expected[m] * (1 + 1e-2)) << m;
    EXPECT_LE(number(r, "residuals." + std::to_string(6 + m)), 1e-8);
  }
}

TEST_F(Igasolve, ReportsTheTimeStepAndTheLargestFrequency) {
  const auto largest = json({"eigen", "cube.h5", "--largest", "--light-functions", "none"});
  const auto step = json({"timestep", "cube.h5", "--light-functions", "none"});
  const double omega = number(largest, "omega_max");
  EXPECT_NEAR(number(largest, "dt_crit"), 2 / omega, 1e-12);
  EXPECT_NEAR(number(step, "omega_max") / omega, 1, 1e-3);
  EXPECT_GE(number(step, "omega_max_bound"), omega);
  EXPECT_GE(number(largest, "omega_max_bound"), omega);
  EXPECT_GE(number(largest, "omega_spans"), omega); // from the spans alone
  // and the default remedy needs no larger step than the spans give
  EXPECT_GT(number(json({"timestep", "cube.h5"}), "dt_crit"), 0.8 * number(largest, "dt_crit"));
}

TEST_F(Igasolve, WritesResultsOnceAndReplacesThemOnlyWhenAsked) {
  EXPECT_EQ(run({"eigen", "cube.h5", "--modes", "2", "-o", "modes.h5", "--quiet"}).exit_code, 0);
  EXPECT_EQ(entries(folder.path()), (std::vector<std::string>{"cube.h5", "modes.h5", "modes.pvd", "modes_vtp"}));
  const std::string bytes = read_bytes(folder / "modes.h5");
  const ProgramRun again = run({"eigen", "cube.h5", "--modes", "3", "-o", "modes.h5"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("--force"), std::string::npos) << again.err;
  EXPECT_EQ(read_bytes(folder / "modes.h5"), bytes);
  EXPECT_EQ(run({"eigen", "cube.h5", "--modes", "3", "-o", "modes.h5", "--force"}).exit_code, 0);
}

TEST_F(Igasolve, TakesARunFileAndFlagsOverrideIt) {
  write_bytes(folder / "run.toml",
              "model = \"cube.h5\"\nunits = \"mm\"\n[material]\nE = 4\nnu = 0.3\nrho = 1\n[eigen]\nmodes = 1\n");
  const auto file = json({"eigen", "run.toml"}, false),
             flags = json({"eigen", "run.toml", "--E", "1", "--modes", "2"}, false);
  EXPECT_EQ(number(file, "elastic_modes"), 1);
  EXPECT_EQ(number(flags, "elastic_modes"), 2);
  EXPECT_NEAR(number(file, "frequencies.6") / number(flags, "frequencies.6"), 2, 1e-9);
}

TEST_F(Igasolve, SolvesAColumnUnderItsOwnPressure) {
  write_bytes(folder / "column.toml", R"(
model = "cube.h5"
[material]
E = 100
nu = 0
[[support]]
name = "foot"
normal.direction = [0, 0, -1]
[[load]]
name = "lid"
normal.direction = [0, 0, 1]
pressure = 2
[[probe]]
name = "top"
position = [1.3, 1.4, 1.85]
)");
  const auto r = json({"static", "column.toml", "-o", "column.h5"}, false);
  EXPECT_NEAR(number(r, "statics.supports.0.force.2"), 2, 1e-9);
  EXPECT_NEAR(number(r, "statics.probes.0.displacement.2"), -0.02, 1e-9);
  EXPECT_NEAR(number(r, "statics.probes.0.von_mises"), 2, 1e-7);
}

// What the synthetic model's provenance holds.
constexpr const char *model_warning = "a wall is thinner than a span",
                     *model_finding = "12 duplicate vertices were welded";

TEST_F(Igasolve, RepeatsWarningsAndFindingsOfTheModelBesideEveryResult) {
  write_bytes(folder / "held.toml", "model = \"cube.h5\"\n[material]\nE = 1\nnu = 0.3\n[[support]]\nwhole_surface = "
                                    "true\n[[load]]\nbody_force = [0, 0, 1]\n");
  write_bytes(folder / "flight.toml", "[[bodies]]\nname = \"cube\"\nmodel = \"cube.h5\"\nmaterial = { law = "
                                      "\"neo-hookean\", E = 1, nu = 0.3, rho = 1e-9 }\n[time]\nend = 1e-4\n[output]\n"
                                      "interval = 1e-4\n");
  const std::vector<std::vector<std::string>> commands{{"eigen", "cube.h5", "--modes", "2"},
                                                       {"eigen", "cube.h5", "--largest"},
                                                       {"timestep", "cube.h5"},
                                                       {"static", "held.toml"},
                                                       {"explicit", "flight.toml", "-o", "flight.h5", "--force"},
                                                       {"info", "cube.h5"},
                                                       {"check", "cube.h5"}};
  for (const auto& command : commands) {
    const bool with_material = command[0] == "eigen" || command[0] == "timestep";
    const ProgramRun text = run(command, with_material);
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_NE(text.out.find(model_warning), std::string::npos) << command[0] << ": " << text.out;
    EXPECT_NE(text.out.find(model_finding), std::string::npos) << command[0] << ": " << text.out;
    auto report = json(command, with_material);
    EXPECT_NE(report["warnings.0"].find(model_warning), std::string::npos) << command[0];
    EXPECT_NE(report["findings.0"].find(model_finding), std::string::npos) << command[0];
  }
}

TEST_F(Igasolve, WarnsOfAMaterialThatFitsNoUnitsOfTheModel) {
  const auto steel = [&](const char* E, const char* rho) {
    return run({"eigen", "cube.h5", "--modes", "1", "--E", E, "--nu", "0.3", "--rho", rho}, false).err;
  };
  EXPECT_NE(steel("210e9", "7850").find("E = 210000, rho = 7.85e-09 in t, mm, s"), std::string::npos);
  EXPECT_EQ(steel("210000", "7.85e-9").find("no solid"), std::string::npos);
  EXPECT_EQ(steel("210", "7.85e-6").find("no solid"), std::string::npos);
}

TEST_F(Igasolve, TakesAMaterialByName) {
  write_bytes(folder / "named.toml", "model = \"cube.h5\"\nmaterial = \"steel\"\n");
  write_bytes(folder / "table.toml", "model = \"cube.h5\"\nunit_system = \"kg-mm-ms\"\n[material]\nname = \"Steel\"\n");
  const auto in_tonnes = json({"eigen", "named.toml", "--modes", "1"}, false),
             in_kg = json({"eigen", "table.toml", "--modes", "1"}, false),
             flag = json({"eigen", "cube.h5", "--modes", "1", "--material", "steel"}, false),
             own = json({"eigen", "named.toml", "--modes", "1", "--E", "840000"}, false);
  EXPECT_NEAR(number(in_tonnes, "material.E"), 210000, 1e-6);
  EXPECT_NEAR(number(in_kg, "material.E"), 210, 1e-9);
  for (const auto& report : {in_tonnes, in_kg, flag})
    EXPECT_NEAR(number(report, "material.mass_in_kg"), 7.85e-6, 1e-12);                         // 1 mm³
  EXPECT_NEAR(number(in_tonnes, "frequencies.6") / number(in_kg, "frequencies.6"), 1000, 1e-5); // 1/s, 1/ms
  EXPECT_EQ(number(flag, "frequencies.6"), number(in_tonnes, "frequencies.6"));
  EXPECT_NEAR(number(own, "frequencies.6") / number(flag, "frequencies.6"), 2, 1e-9);
  const ProgramRun text = run({"timestep", "named.toml"}, false);
  EXPECT_NE(text.out.find("steel: E = 210000 MPa, nu = 0.3, rho = 7.85e-09 t/mm³"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("the part has a mass of 7.85e-06 kg"), std::string::npos) << text.out;
}

// A cube that stands on the four edges of its foot: what the report says where numbers have no limit.
TEST_F(Igasolve, SaysWhereNumbersOfLinesAndPointsHaveNoLimit) {
  write_bytes(folder / "edges.toml", R"(
model = "cube.h5"
material = "steel"
[[support]]
name = "edges"
line = [[0.8, 0.9, 0.85], [1.8, 0.9, 0.85], [1.8, 1.9, 0.85], [0.8, 1.9, 0.85], [0.8, 0.9, 0.85]]
[[load]]
name = "push"
at = [1.3, 1.4, 1.85]
force = [0, 0, -1]
[[probe]]
name = "corner"
position = [0.8, 0.9, 0.85]
)");
  const ProgramRun text = run({"static", "edges.toml"}, false);
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* words : {"support 'edges' (penalty): length 4, centroid (1.3, 1.4, 0.85)", "reaction (0, 0, 1)",
                            "no stress to rely on: within two spans of support 'edges'"})
    EXPECT_NE(text.out.find(words), std::string::npos) << words << " in: " << text.out;
  for (const char* words : {"support 'edges' acts along a line, which has no area", "load 'push' acts at a point"})
    EXPECT_NE(text.err.find(words), std::string::npos) << words << " in: " << text.err;
  const auto r = json({"static", "edges.toml"}, false);
  EXPECT_NEAR(number(r, "statics.supports.0.length"), 4, 1e-12);
  EXPECT_EQ(r.at("statics.probes.0.no_limit_beside"), "support 'edges'");
  for (const char* analysis : {"eigen", "timestep"}) {
    const ProgramRun modes = run({analysis, "edges.toml"}, false);
    EXPECT_EQ(modes.exit_code, 0) << modes.err;
    EXPECT_NE(modes.out.find("edges: length 4"), std::string::npos) << modes.out;
    EXPECT_NE(modes.err.find("along a line"), std::string::npos) << modes.err;
  }
}

struct Case {
  const char* name;
  std::vector<std::string> arguments; // material flags are added unless a run file is given
  int exit_code;
  std::vector<std::string> words;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

struct IgasolveRefuses : testing::TestWithParam<Case> {
  TempFolder folder;
  RunOptions options;
  void SetUp() override {
    options.folder = folder.path();
    const TrimmedModel model = make_box_model(a_cube());
    io::write_model(folder / "cube.h5", model);
    write_bytes(folder / "notes.h5", "no model\n");
    write_bytes(folder / "cut.h5", read_bytes(folder / "cube.h5").substr(0, 3000));
    const std::string head = "model = \"cube.h5\"\n[material]\nE = 1\nnu = 0.3\nrho = 1\n";
    write_bytes(folder / "unknown.toml", head + "[eigen]\nmods = 3\n");
    write_bytes(folder / "load.toml", head +
                                          "[[support]]\nwhole_surface = true\n[[load]]\nname = \"heat\"\ntemperature "
                                          "= 40\n");
    write_bytes(folder / "support.toml", head + "[[support]]\nplain.point = [0, 0, 0]\n");
    write_bytes(folder / "type.toml", head + "[eigen]\nmodes = \"three\"\n");
    write_bytes(folder / "units.toml", "units = \"inch\"\n" + head);
    write_bytes(
        folder / "C.toml", "model = \"cube.h5\"\n[material]\nrho = 1\nC = [" + [] {
          std::string text;
          for (int i = 0; i < 36; ++i) text += i % 7 ? "0, " : i == 35 ? "-1" : "1, ";
          return text;
        }() + "]\n");
    write_bytes(folder / "free.toml", head + "[[load]]\nname = \"push\"\nnormal.direction = [0, 0, 1]\npressure = 1\n");
    write_bytes(folder / "gravity.toml", "model = \"cube.h5\"\n[material]\nE = 1\nnu = 0.3\n[[support]]\nwhole_surface "
                                         "= true\n[[load]]\nacceleration = [0, 0, -9.81]\n");
    write_bytes(folder / "sliding.toml",
                head + "[[support]]\nname = \"floor\"\nnormal.direction = [0, 0, -1]\nfixed = \"z\"\n");
    write_bytes(folder / "multipliers.toml", head + "[[support]]\nwhole_surface = true\nmethod = \"lagrange\"\n");
    write_bytes(folder / "stele.toml", "model = \"cube.h5\"\nmaterial = \"stele\"\n");
    write_bytes(
        folder / "both.toml",
        "model = \"cube.h5\"\n[material]\nname = \"steel\"\nC = [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, "
        "0, 1, 0, 1]\n");
    write_bytes(folder / "metres.toml", "unit_system = \"SI\"\nmodel = \"cube.h5\"\nmaterial = \"steel\"\n");
    TrimmedModel unknown = model;
    unknown.length_unit = "unspecified";
    io::write_model(folder / "unknown.h5", unknown);
    write_bytes(folder / "no_curve.toml", head + "[[support]]\ncurve = \"edge 12\"\n");
    write_bytes(folder / "no_patch.toml", head + "[[support]]\nname = \"heads\"\npatch = \"heads.stl\"\n");
    write_bytes(folder / "no_bore.toml", head + "[[support]]\nname = \"pin\"\nregion = \"u+\"\nfixed = \"pinned\"\n");
    write_bytes(folder / "nowhere.toml", head + "[[support]]\nname = \"roof\"\nbox = [5, 5, 5, 6, 6, 6]\n");
    write_bytes(
        folder / "outside.toml",
        head + "[[support]]\nname = \"all\"\nwhole_surface = true\n[[probe]]\nname = \"far\"\nposition = [9, 9, 9]\n");
  }
};

TEST_P(IgasolveRefuses, WithItsCodeAndAMessage) {
  const Case& c = GetParam();
  std::vector<std::string> arguments = c.arguments;
  const bool has_run_file = arguments.size() > 1 && arguments[1].ends_with(".toml");
  if (!has_run_file && arguments.size() > 1 && arguments[0] != "info" && arguments[0] != "check" &&
      arguments[0] != "export")
    for (std::size_t k = 0; k < material.size(); k += 2)
      if (std::find(arguments.begin(), arguments.end(), material[k]) == arguments.end())
        arguments.insert(arguments.end(), {material[k], material[k + 1]});
  const auto before = entries(folder.path());
  const ProgramRun run = run_program(IGASOLVE, arguments, options);
  EXPECT_EQ(run.exit_code, c.exit_code) << run.err;
  EXPECT_EQ(run.out, "");
  for (const std::string& word : c.words)
    EXPECT_NE(run.err.find(word), std::string::npos) << word << " is missing in: " << run.err;
  EXPECT_EQ(entries(folder.path()), before);
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, IgasolveRefuses,
    testing::Values(
        Case{"NoCommand", {}, 2, {"--help"}}, Case{"NoModel", {"eigen"}, 2, {"no model file"}},
        Case{"Missing", {"eigen", "absent.h5"}, 2, {"absent.h5"}},
        Case{"NotAModel", {"eigen", "notes.h5"}, 3, {"notes.h5"}},
        Case{"Truncated", {"eigen", "cut.h5"}, 3, {"cut.h5"}},
        Case{"UnknownCommand", {"egien", "cube.h5"}, 2, {"egien", "did you mean eigen", "timestep"}},
        Case{"UnknownCommandWithFlags", {"modal", "cube.h5"}, 2, {"unknown command modal", "export"}},
        Case{"UnknownFlagOfACommandWithoutFile", {"info", "--jsn"}, 2, {"--jsn", "did you mean --json"}},
        Case{"TooManyArguments", {"info", "cube.h5", "notes.h5"}, 2, {"notes.h5", "too many"}},
        Case{"OutputAsTable", {"eigen", "cube.h5", "-o", "modes.csv"}, 2, {"modes.csv", "modes.h5", "igasolve export"}},
        Case{"OutputForAViewer", {"eigen", "cube.h5", "-o", "modes.VTU"}, 2, {"modes.VTU", "modes.h5", "ParaView"}},
        Case{"OutputAsReport", {"eigen", "cube.h5", "-o", "modes.json"}, 2, {"modes.json", "--json"}},
        Case{"ExportWithoutAFormat", {"export", "cube.h5"}, 2, {"--csv"}},
        Case{"ExportOfAnUnknownTable",
             {"export", "cube.h5", "--csv", "--table", "point"},
             2,
             {"point", "did you mean points"}},
        Case{"ExportOfNothing", {"export", "absent.h5", "--csv"}, 2, {"absent.h5"}},
        Case{"ExportOntoAFile", {"export", "cube.h5", "--csv", "-o", "notes.h5"}, 2, {"notes.h5", "folder"}},
        Case{"MissingRunFile", {"eigen", "absent.toml"}, 2, {"absent.toml"}},
        Case{"UnknownFlag", {"eigen", "cube.h5", "--mods", "3"}, 2, {"--mods", "--modes"}},
        Case{"UnknownKey", {"eigen", "unknown.toml"}, 2, {"unknown.toml:7", "mods", "modes"}},
        Case{"UnknownKeyOfALoad", {"static", "load.toml"}, 2, {"load.toml:10", "temperature", "[load]"}},
        Case{"UnknownKeyOfASupport", {"static", "support.toml"}, 2, {"support.toml:7", "plain", "plane"}},
        Case{"WrongType", {"eigen", "type.toml"}, 2, {"type.toml:7", "modes", "\"three\"", "integer"}},
        Case{"OtherUnits", {"eigen", "units.toml"}, 2, {"inch", "mm"}},
        Case{"Incompressible", {"eigen", "cube.h5", "--nu", "0.5"}, 2, {"nu = 0.5", "incompressible"}},
        Case{"NegativeModulus", {"eigen", "cube.h5", "--E", "-1"}, 2, {"E = -1", "positive"}},
        Case{"NoDensity", {"eigen", "cube.h5", "--rho", "0"}, 2, {"rho = 0"}},
        Case{"NotDefinite", {"eigen", "C.toml"}, 2, {"positive definite"}},
        Case{"UnknownMass", {"eigen", "cube.h5", "--mass", "lumpt"}, 2, {"lumpt", "lumped"}},
        Case{"UnknownRemedy", {"eigen", "cube.h5", "--light-functions", "lineal"}, 2, {"lineal", "linear"}},
        Case{"NoModes", {"eigen", "cube.h5", "--modes", "0"}, 2, {"modes", "0"}},
        Case{"MoreModesThanUnknowns", {"eigen", "cube.h5", "--modes", "900000"}, 2, {"900000", "unknowns"}},
        Case{"OutputFolderMissing", {"eigen", "cube.h5", "-o", "nowhere/modes.h5"}, 2, {"nowhere"}},
        Case{"AllRemoved",
             {"eigen", "cube.h5", "--light-functions", "remove", "--light-threshold", "0.9999"},
             2,
             {"threshold"}},
        Case{"NoSupports", {"static", "free.toml"}, 2, {"translation", "rotation"}},
        Case{"TooFewSupports", {"static", "sliding.toml"}, 2, {"translation", "rotation"}},
        Case{"NoDensityForGravity", {"static", "gravity.toml"}, 2, {"rho", "acceleration"}},
        Case{"LargestWithMultipliers", {"eigen", "multipliers.toml", "--largest"}, 2, {"Lagrange multipliers"}},
        Case{"TimestepWithMultipliers", {"timestep", "multipliers.toml"}, 2, {"Lagrange multipliers"}},
        Case{"UnknownMaterial", {"eigen", "stele.toml"}, 2, {"\"stele\"", "did you mean \"steel\"", "brass"}},
        Case{"NameAndMatrix", {"eigen", "both.toml"}, 2, {"steel", "matrix C"}},
        Case{"UnitsOfAnotherLength", {"eigen", "metres.toml"}, 2, {"SI", "lengths in m", "t-mm-s or kg-mm-ms"}},
        Case{"NameWithoutALengthUnit",
             {"eigen", "unknown.h5", "--material", "steel"},
             2,
             {"unknown.h5", "no length unit", "--length-unit mm"}},
        Case{"UnknownCurve", {"static", "no_curve.toml"}, 2, {"support 1", "'edge 12'", "CAD"}},
        Case{"MissingPatch", {"static", "no_patch.toml"}, 2, {"heads.stl"}},
        Case{"NoCylinder", {"static", "no_bore.toml"}, 2, {"support 'pin'", "no cylinder", "flat"}},
        Case{"EmptyRegion", {"static", "nowhere.toml"}, 2, {"roof"}},
        Case{"ProbeOutside", {"static", "outside.toml"}, 2, {"far"}}),
    [](const testing::TestParamInfo<Case>& chosen) { return chosen.param.name; });

TEST_F(Igasolve, RefusesAReadOnlyFolderBeforeItWorks) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  std::filesystem::create_directory(folder / "closed");
  std::filesystem::permissions(folder / "closed",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const ProgramRun r = run({"eigen", "cube.h5", "-o", "closed/modes.h5"});
  std::filesystem::permissions(folder / "closed", std::filesystem::perms::owner_all);
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.err.find("closed"), std::string::npos) << r.err;
}

} // namespace
} // namespace iga::test
