// Materials by name: the table that is built in, a user's own, units by the model's length unit.
#include "solver/mechanics/material_table.hpp"

#include "format/model/errors.hpp"
#include "tests/support/temp_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

namespace {

template <class Call> void expect_refused(Call&& call, const std::vector<std::string>& words) {
  try {
    call();
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in: " << error.what();
  }
}

} // namespace

TEST(MaterialTable, KnowsNamesAndTheirAliases) {
  const NamedMaterial steel = find_material("steel", {});
  EXPECT_EQ(steel.E, 210e9);
  EXPECT_EQ(steel.nu, 0.3);
  EXPECT_EQ(steel.rho, 7850);
  EXPECT_NE(steel.source.find("EN 1993-1-1"), std::string::npos);
  EXPECT_EQ(find_material("STEEL", {}).name, "steel");
  EXPECT_EQ(find_material("aluminum", {}).name, "aluminium");
  EXPECT_EQ(find_material("1.4301", {}).name, "stainless steel");
  expect_refused([] { find_material("stele", {}); },
                 {"there is no \"stele\" in the table of materials", "did you mean \"steel\"", "brass", "as numbers"});
}

TEST(MaterialTable, TakesAFileOfTheUsersOwn) {
  const test::TempFolder folder;
  const auto file = folder / "my.toml";
  const auto find = [&](const char* text, const char* name = "oak") {
    std::ofstream(file) << text;
    return find_material(name, file);
  };
  EXPECT_EQ(find("[oak]\nE = 11e9\nnu = 0.3\nrho = 700\n").E, 11e9);
  EXPECT_EQ(find("[\"EN 338 D30\"]\naliases = [\"oak\"]\nE = 11e9\nnu = 0.3\nrho = 700\n").name, "EN 338 D30");
  expect_refused([&] { find("[oak]\nE = 11e9\nnu = 0.3\nrho = 700\n", "steel"); },
                 {"no \"steel\" in", "my.toml", "oak"});
  expect_refused([&] { find("[oak]\nE = 11000\nnu = 0.3\nrho = 700\n"); }, {"my.toml:2", "E is in Pa"});
  expect_refused([&] { find("[oak]\nE = 11e9\nnu = 0.3\n"); }, {"my.toml:1", "'rho' in [oak]", "missing"});
  expect_refused([&] { find("[oak]\nE = 11e9\nnu = 0.7\nrho = 700\n"); }, {"my.toml:2", "nu = 0.7"});
  expect_refused([&] { find("[oak]\nE = 11e9\nnu = 0.3\nrho = 700\ncolour = 3\n"); }, {"my.toml:5", "colour"});
  expect_refused([&] { find("E = 11e9\n"); }, {"my.toml:1", "outside of a material"});
  expect_refused([&] { find_material("oak", folder / "missing.toml"); }, {"missing.toml"});
}

TEST(UnitSystems, FollowTheLengthUnitOfTheModel) {
  EXPECT_EQ(choose_units({}, "mm", "part.h5").name, "t-mm-s");
  EXPECT_EQ(choose_units({}, "millimetre", "part.h5").name, "t-mm-s");
  EXPECT_EQ(choose_units({}, "m", "part.h5").name, "SI");
  EXPECT_EQ(choose_units("kg-mm-ms", "mm", "part.h5").name, "kg-mm-ms");
  expect_refused([] { choose_units("SI", "mm", "part.h5"); },
                 {"\"SI\" has lengths in m", "part.h5", "\"mm\"", "choose t-mm-s or kg-mm-ms"});
  expect_refused([] { choose_units("t-mm-s", "m", "part.h5"); }, {"lengths in mm", "choose SI"});
  expect_refused([] { choose_units("SI", "in", "part.h5"); }, {"as numbers"});
  expect_refused([] { choose_units("tms", "mm", "part.h5"); }, {"\"tms\"", "t-mm-s, kg-mm-ms, SI"});
  expect_refused([] { choose_units({}, "unspecified", "part.h5"); }, {"part.h5", "no length unit", "--length-unit mm"});
  expect_refused([] { choose_units("SI", "unspecified", "part.h5"); }, {"part.h5", "no length unit"});
  expect_refused([] { choose_units({}, "in", "part.h5"); }, {"part.h5", "\"in\"", "in mm or m"});
}

// The wave speed √(E/ρ) and the mass of a part are what they are in any units.
TEST(UnitSystems, AreConsistent) {
  for (const char* name : {"t-mm-s", "kg-mm-ms", "SI"}) {
    const UnitSystem& units = choose_units(name, std::string(name) == "SI" ? "m" : "mm", "part.h5");
    const double E = 210e9 / units.pascal(), rho = 7850 / units.kg_per_m3();
    EXPECT_NEAR(std::sqrt(E / rho) * units.m / units.s, std::sqrt(210e9 / 7850), 1e-9);
    const double cubic_decimetre = 1e-3 / (units.m * units.m * units.m);
    const MaterialWords words{"steel", "a norm", E, 0.3, rho, &units};
    EXPECT_NEAR(mass_in_kg(words, cubic_decimetre).value_or(0), 7.85, 1e-12);
    EXPECT_NE(material_text(words, cubic_decimetre).find("the part has a mass of 7.85 kg"), std::string::npos);
  }
  EXPECT_NEAR(210e9 / choose_units({}, "mm", "").pascal(), 210000, 1e-9);
  EXPECT_NEAR(7850 / choose_units({}, "mm", "").kg_per_m3(), 7.85e-9, 1e-23);
  const MaterialWords steel{"steel", "a norm", 210e3, 0.3, 7.85e-9, &choose_units({}, "mm", "")};
  EXPECT_EQ(material_text(steel, 1000),
            "steel: E = 210000 MPa, nu = 0.3, rho = 7.85e-09 t/mm³; units t-mm-s; from a norm\n"
            "the part has a mass of 0.00785 kg");
  EXPECT_EQ(material_text({"", "", 1.0, 0.3, 1.0, nullptr}, 5),
            "E = 1, nu = 0.3, rho = 1; in the units of model and run file");
}
