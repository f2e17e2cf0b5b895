#include "preprocessor/program/settings.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/program/command_line.hpp"
#include "preprocessor/program/settings_table.hpp"
#include "tests/support/temp_folder.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace iga::prep {
namespace {

TypedSettings minimal() {
  TypedSettings typed;
  typed.input = "part.stl";
  return typed;
}

template <class Change> std::string refusal(Change&& change) {
  TypedSettings typed = minimal();
  change(typed);
  try {
    validate(typed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

#define EXPECT_REFUSED(word, statement)                                                                                \
  {                                                                                                                    \
    const std::string message = refusal([](TypedSettings& t) { statement; });                                          \
    EXPECT_NE(message.find(word), std::string::npos) << message;                                                       \
  }

TEST(Settings, DefaultsComeFromTheInputsName) {
  TypedSettings typed;
  typed.input = "folder/part.v2.stl";
  const Settings s = validate(typed);
  EXPECT_EQ(s.output, "part.v2.h5");
  EXPECT_EQ(s.title, "part.v2");
  EXPECT_EQ(s.length_unit, "unspecified");
  EXPECT_EQ(s.grid.degree, (std::array<int, 3>{2, 2, 2}));
  EXPECT_EQ(s.quadrature.moment_degree, (std::array<int, 3>{2, 2, 2}));
}

TEST(Settings, FileIsReadWithPathsRelativeToIt) {
  const test::TempFolder folder;
  std::filesystem::create_directory(folder / "sub");
  const auto file = folder / "sub/prep.toml";
  test::write_bytes(file, R"(
input = "../part.stl"
output = "part.h5"
scale = 2
length_unit = "mm"
title = "A part"
[surface]
repair = true
region_angle = 30
[grid]
spans = [3, 4, 5]
degree = [1, 2, 3]
box = [0, 0, 0, 1, 2, 3.5]
rotate_axis_angle = [0, 0, 1, 90]
[trim]
sliver_tolerance = 1e-4
min_fraction = 0.01
[quadrature]
interior = "gauss"
trimmed = "minimal"
moment_degree = "2p"
tolerance = 1e-9
rank_bound = true
)");
  const Settings s = validate(read_settings_file(file));
  EXPECT_EQ(s.input, folder / "part.stl");
  EXPECT_EQ(s.output, folder / "sub/part.h5");
  EXPECT_EQ(s.scale, 2);
  EXPECT_EQ(s.title, "A part");
  EXPECT_TRUE(s.surface.repair);
  EXPECT_EQ(s.quadrature.trimmed_rule, "minimal");
  EXPECT_TRUE(s.quadrature.rank_bound);
  EXPECT_EQ(s.surface.region_angle, 30);
  EXPECT_EQ(s.grid.spans, (std::vector<std::int64_t>{3, 4, 5}));
  EXPECT_EQ((*s.grid.box)[1], (Point3{1, 2, 3.5}));
  EXPECT_EQ(s.quadrature.moment_degree, (std::array<int, 3>{2, 4, 6}));
  EXPECT_EQ(s.grid.rotation, (Rotation{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}));
  EXPECT_EQ(s.trim.min_fraction, 0.01);
  EXPECT_EQ(s.quadrature.tolerance, 1e-9);
}

TEST(Settings, FileWithAnUnknownKeyNamesLineAndNearestKey) {
  const test::TempFolder folder;
  const auto file = folder / "prep.toml";
  test::write_bytes(file, "input = \"a.stl\"\n[grid]\nspan_sizes = 3\n");
  try {
    read_settings_file(file);
    FAIL();
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("prep.toml:3: unknown key 'span_sizes' in [grid]"), std::string::npos) << message;
    EXPECT_NE(message.find("'span_size' in [grid]"), std::string::npos) << message;
  }
}

TEST(Settings, FlagsReplaceTheFileAndDropWhatTheyExclude) {
  TypedSettings file = minimal();
  file.span_size = {{10}};
  file.degree = {{3}};
  file.rotation = std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1};
  TypedSettings flags;
  flags.spans = {{7}};
  flags.rotate_axis_angle = std::vector<double>{0, 0, 1, 30};
  const Settings s = validate(override_settings(file, flags));
  EXPECT_EQ(s.input, "part.stl");
  EXPECT_EQ(s.grid.spans, std::vector<std::int64_t>{7});
  EXPECT_TRUE(s.grid.span_size.empty());
  EXPECT_EQ(s.grid.degree[0], 3);
  EXPECT_NEAR(s.grid.rotation[0][0], std::sqrt(3.0) / 2, 1e-15);
}

TEST(Settings, AxisAndAngleGiveARotationAboutThatAxis) {
  TypedSettings typed = minimal();
  typed.rotate_axis_angle = std::vector<double>{1, 2, -2, 77};
  const Rotation R = validate(typed).grid.rotation;
  // The axis stays, the trace is 1 + 2 cos.
  for (std::size_t r = 0; r < 3; ++r) {
    const Point3 axis{1, 2, -2};
    EXPECT_NEAR(R[r][0] * 1 + R[r][1] * 2 + R[r][2] * -2, axis[r], 1e-14);
  }
  EXPECT_NEAR(R[0][0] + R[1][1] + R[2][2], 1 + 2 * std::cos(77 * M_PI / 180), 1e-14);
  // Right-handed: about z, x turns towards y.
  typed.rotate_axis_angle = std::vector<double>{0, 0, 5, 30};
  EXPECT_NEAR(validate(typed).grid.rotation[1][0], 0.5, 1e-15);
}

TEST(Settings, ValuesOutOfRangeAreRefusedByName) {
  EXPECT_REFUSED("degree = 0", (t.degree = {{0}}));
  EXPECT_REFUSED("degree = 9", (t.degree = {{2, 9, 2}}));
  EXPECT_REFUSED("1 or 3", (t.degree = {{2, 2}}));
  EXPECT_REFUSED("span_size = 0", (t.span_size = {{0}}));
  EXPECT_REFUSED("span_size = -1", (t.span_size = {{1, -1, 1}}));
  EXPECT_REFUSED("span_size = nan", (t.span_size = {{std::nan("")}}));
  EXPECT_REFUSED("spans = 0", (t.spans = {{0}}));
  EXPECT_REFUSED("both spans and span_size", (t.spans = {{1}}, t.span_size = {{1}}));
  EXPECT_REFUSED("scale = 0", (t.scale = 0));
  EXPECT_REFUSED("scale = inf", (t.scale = INFINITY));
  EXPECT_REFUSED("margin = -1", (t.margin = -1));
  EXPECT_REFUSED("box is empty along y", (t.box = std::vector<double>{0, 0, 0, 1, 0, 1}));
  EXPECT_REFUSED("margin and box", (t.margin = 1, t.box = std::vector<double>{0, 0, 0, 1, 1, 1}));
  EXPECT_REFUSED("optimise_offset and box", (t.optimise_offset = true, t.box = std::vector<double>{0, 0, 0, 1, 1, 1}));
  EXPECT_REFUSED("rotation", (t.rotation = std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 2}));
  EXPECT_REFUSED("axis must not be zero", (t.rotate_axis_angle = std::vector<double>{0, 0, 0, 30}));
  EXPECT_REFUSED("sliver_tolerance = 1", (t.sliver_tolerance = 1));
  EXPECT_REFUSED("min_fraction = 1", (t.min_fraction = 1));
  EXPECT_REFUSED("gap_ends = \"tied\" is not known; choose split or glued", (t.gap_ends = "tied"));
  EXPECT_REFUSED("tolerance = 0", (t.tolerance = 0));
  EXPECT_REFUSED("moment_degree = 5", (t.moment_degree = std::vector<std::int64_t>{5}));
  EXPECT_REFUSED("moment_degree = \"3p\"", (t.moment_degree = "3p"));
  EXPECT_REFUSED("choose gauss, ggq", (t.interior = "simpson"));
  EXPECT_REFUSED("hourglass", (t.interior = "ggq-reduced2"));
  EXPECT_REFUSED("hourglass", (t.interior = "ggq-reduced2", t.degree = {{3, 2, 3}}));
  EXPECT_REFUSED("choose nnls or minimal", (t.trimmed = "least"));
  EXPECT_REFUSED("rank_bound", (t.trimmed = "nnls", t.rank_bound = true));
  EXPECT_REFUSED("belong to wrapping", (t.wrap_alpha = 1));
  EXPECT_REFUSED("region_angle = -3", (t.region_angle = -3));
  EXPECT_REFUSED("no surface file", (t.input.reset()));
}

TEST(Settings, RulesFollowTheMomentsWhereTheyAreNotChosen) {
  const auto rule = [](auto&& change) {
    TypedSettings typed = minimal();
    change(typed);
    const Settings s = validate(typed);
    EXPECT_EQ(s.quadrature.interior_rule, "ggq");
    return s.quadrature.trimmed_rule;
  };
  EXPECT_EQ(rule([](auto&) {}), "minimal");
  EXPECT_EQ(rule([](auto& t) { t.degree = {{1}}; }), "minimal");
  EXPECT_EQ(rule([](auto& t) { t.degree = {{2, 2, 3}}; }), "nnls");
  EXPECT_EQ(rule([](auto& t) { t.moment_degree = "2p"; }), "nnls");
  EXPECT_EQ(rule([](auto& t) { t.degree = {{3}}, t.trimmed = "minimal"; }), "minimal");
}

TEST(Settings, CanonicalTextTellsDataApartAndIgnoresHowItWasTyped) {
  const std::string base = canonical_text(validate(minimal()));
  const auto changed = [&](auto&& change) {
    TypedSettings typed = minimal();
    change(typed);
    return canonical_text(validate(typed)) != base;
  };
  EXPECT_TRUE(changed([](auto& t) { t.scale = 1 + 1e-15; }));
  EXPECT_TRUE(changed([](auto& t) { t.span_size = {{2}}; }));
  EXPECT_TRUE(changed([](auto& t) { t.spans = {{20}}; }));
  EXPECT_TRUE(changed([](auto& t) { t.title = "other"; }));
  EXPECT_TRUE(changed([](auto& t) { t.region_angle = 30; }));
  EXPECT_TRUE(changed([](auto& t) { t.rotate_axis_angle = std::vector<double>{0, 0, 1, 1}; }));
  EXPECT_TRUE(changed([](auto& t) { t.moment_degree = "2p"; }));
  EXPECT_TRUE(changed([](auto& t) { t.interior = "ggq-reduced"; }));
  EXPECT_TRUE(changed([](auto& t) { t.trimmed = "nnls"; }));
  EXPECT_TRUE(changed([](auto& t) { t.rank_bound = true; }));
  EXPECT_TRUE(changed([](auto& t) { t.optimise_offset = true; }));
  EXPECT_FALSE(changed([](auto& t) { t.output = "elsewhere.h5"; }));
  EXPECT_FALSE(changed([](auto& t) { t.degree = {{2, 2, 2}}; }));
  EXPECT_FALSE(changed([](auto& t) { t.moment_degree = "p"; }));
  EXPECT_FALSE(changed([](auto& t) { t.interior = "ggq"; }));
  EXPECT_FALSE(changed([](auto& t) { t.trimmed = "minimal"; }));
  EXPECT_FALSE(changed([](auto& t) { t.rotate_axis_angle = std::vector<double>{0, 0, 1, 0}; }));
  TypedSettings one = minimal(), three = minimal();
  one.span_size = {{2}};
  three.span_size = {{2, 2, 2}};
  EXPECT_EQ(canonical_text(validate(one)), canonical_text(validate(three)));
}

// A value other than the default for each setting, as a settings file has it, and what else it needs.
struct Sample {
  std::string value;
  std::vector<std::pair<std::string, std::string>> with; // table.key, value
};

const std::map<std::string, Sample>& samples() {
  static const std::map<std::string, Sample> all{{"input", {"\"other.stl\"", {}}},
                                                 {"output", {"\"other.h5\"", {}}},
                                                 {"scale", {"2.5", {}}},
                                                 {"length_unit", {"\"mm\"", {}}},
                                                 {"title", {"\"a part\"", {}}},
                                                 {"chord", {"0.02", {}}},
                                                 {"solid", {"\"bolt\"", {}}},
                                                 {"merge", {"true", {}}},
                                                 {"sew", {"0.001", {}}},
                                                 {"repair", {"true", {}}},
                                                 {"wrap", {"true", {}}},
                                                 {"wrap_alpha", {"0.5", {{"surface.wrap", "true"}}}},
                                                 {"wrap_offset", {"0.25", {{"surface.wrap", "true"}}}},
                                                 {"region_angle", {"30", {}}},
                                                 {"accept_leaks", {"true", {}}},
                                                 {"box", {"[0, 0, 0, 1, 2, 3]", {}}},
                                                 {"spans", {"[3, 4, 5]", {}}},
                                                 {"span_size", {"0.125", {}}},
                                                 {"degree", {"1", {}}},
                                                 {"margin", {"4", {}}},
                                                 {"rotation", {"[0, -1, 0, 1, 0, 0, 0, 0, 1]", {}}},
                                                 {"rotate_axis_angle", {"[0, 0, 1, 90]", {}}},
                                                 {"optimise_offset", {"true", {}}},
                                                 {"sliver_tolerance", {"1e-4", {}}},
                                                 {"min_fraction", {"0.01", {}}},
                                                 {"gap_ends", {"\"glued\"", {}}},
                                                 {"interior", {"\"gauss\"", {}}},
                                                 {"trimmed", {"\"nnls\"", {}}},
                                                 {"surface_rule", {"\"reduced\"", {}}},
                                                 {"moment_degree", {"\"2p\"", {}}},
                                                 {"tolerance", {"1e-9", {}}},
                                                 {"rank_bound", {"true", {}}}};
  return all;
}

// "[0, 1]" or "\"mm\"" → the words that follow a flag.
std::vector<std::string> words_of(std::string value) {
  std::vector<std::string> words(1);
  for (const char c : value) {
    if (c == ',')
      words.emplace_back();
    else if (std::string("[]\" ").find(c) == std::string::npos || (c == ' ' && value[0] == '"'))
      words.back() += c;
  }
  return words;
}

struct OneSetting {
  std::string table, key, flags;
  bool is_switch = false, affects_data = false;
};

std::vector<OneSetting> all_settings() {
  std::vector<OneSetting> all;
  each_setting([&]<class T>(const Setting<T>& s) {
    all.push_back({s.table, s.key, s.flags(), std::is_same_v<T, bool>, s.canonical != nullptr});
  });
  return all;
}

// One table makes settings file, flags, override and canonical text: each setting reaches all of them.
TEST(SettingsTable, FileAndFlagsGiveTheSameForEverySetting) {
  const test::TempFolder folder;
  const std::string base = canonical_text(validate(minimal()));
  std::set<std::string> seen;
  for (const OneSetting& s : all_settings()) {
    SCOPED_TRACE(s.key);
    EXPECT_TRUE(seen.insert(s.key).second) << "two settings of one name";
    ASSERT_TRUE(samples().contains(s.key)) << "a new setting needs a value here";
    const Sample& sample = samples().at(s.key);
    std::map<std::string, std::string> tables{{"", s.key == "input" ? "" : "input = \"part.stl\"\n"}};
    std::vector<std::string> words{"igaprep"};
    if (s.key != "input") words.push_back("part.stl");
    const auto add = [&](const std::string& table, const std::string& key, const std::string& value) {
      tables[table] += key + " = " + value + "\n";
    };
    add(s.table, s.key, sample.value);
    words.push_back(s.flags.substr(s.flags.find("--")));
    if (!s.is_switch)
      for (const std::string& word : words_of(sample.value)) words.push_back(word);
    for (const auto& [name, value] : sample.with) {
      add(name.substr(0, name.find('.')), name.substr(name.find('.') + 1), value);
      words.push_back("--" + name.substr(name.find('.') + 1));
    }
    std::string text = tables[""];
    for (const auto& [table, lines] : tables)
      if (!table.empty()) text += "[" + table + "]\n" + lines;
    test::write_bytes(folder / "prep.toml", text);
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    const Settings from_file = validate(read_settings_file(folder / "prep.toml"));
    const auto line = parse_command_line(static_cast<int>(argv.size()), argv.data());
    ASSERT_TRUE(line);
    const Settings from_flags = validate(line->typed), over = validate(override_settings(minimal(), line->typed));
    EXPECT_EQ(canonical_text(from_file), canonical_text(from_flags));
    EXPECT_EQ(canonical_text(over), canonical_text(from_flags));
    EXPECT_EQ(from_file.input.filename(), from_flags.input.filename());
    EXPECT_EQ(from_file.output.filename(), from_flags.output.filename());
    // Another input gives another title.
    const bool told = s.affects_data || s.key == "rotate_axis_angle" || s.key == "input";
    EXPECT_EQ(canonical_text(from_flags) != base, told);
  }
}

// The hash of files that stand already is made from this text: it must not change for the same settings.
TEST(SettingsTable, CanonicalTextOfTheDefaults) {
  EXPECT_EQ(canonical_text(validate(minimal())), R"(scale = 1
length_unit = unspecified
title = part
repair = false
wrap = false
accept_leaks = false
spans = 
span_size = 
degree = 2 2 2
rotation = 1 0 0
rotation = 0 1 0
rotation = 0 0 1
optimise_offset = false
sliver_tolerance = 2e-05
min_fraction = 0
gap_ends = split
interior = ggq
trimmed = minimal
surface_rule = exact
moment_degree = 2 2 2
tolerance = 1e-10
rank_bound = false
)");
}

} // namespace
} // namespace iga::prep
