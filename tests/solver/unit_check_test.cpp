// Real solids in every consistent set of units in use raise no warning; numbers typed in another set do.
#include "solver/mechanics/unit_check.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace iga::solve {
namespace {

struct Solid {
  const char* name;
  double E, rho; // Pa, kg/m³
};

// Handbook values, from the softest and lightest to the stiffest and heaviest that parts are made of.
const std::vector<Solid> solids{{"silica aerogel", 1e6, 100},
                                {"soft polyurethane foam", 5e4, 30},
                                {"EPS 15", 3e6, 15},
                                {"EPP 60", 5e7, 60},
                                {"closed-cell PVC foam", 7e7, 80},
                                {"aluminium foam", 1e9, 300},
                                {"balsa", 3e9, 160},
                                {"cork", 2e7, 180},
                                {"oak", 11e9, 700},
                                {"silicone rubber", 1e6, 1100},
                                {"natural rubber", 2e6, 930},
                                {"cartilage", 1e6, 1100},
                                {"bone", 17e9, 1900},
                                {"polyethylene", 0.2e9, 920},
                                {"polyamide", 3e9, 1130},
                                {"PTFE", 0.5e9, 2200},
                                {"ABS", 2.3e9, 1050},
                                {"glass-fibre laminate", 40e9, 1900},
                                {"carbon-fibre laminate", 150e9, 1600},
                                {"ice", 9e9, 917},
                                {"concrete", 30e9, 2400},
                                {"granite", 50e9, 2700},
                                {"sand", 3e7, 1800},
                                {"clay", 1e7, 2000},
                                {"glass", 70e9, 2500},
                                {"magnesium", 45e9, 1740},
                                {"aluminium", 70e9, 2700},
                                {"titanium", 114e9, 4430},
                                {"steel", 210e9, 7850},
                                {"cast iron", 110e9, 7200},
                                {"copper", 120e9, 8960},
                                {"lead", 16e9, 11340},
                                {"gold", 79e9, 19300},
                                {"tungsten", 411e9, 19300},
                                {"tungsten carbide", 650e9, 15600},
                                {"osmium", 550e9, 22590},
                                {"alumina", 380e9, 3950},
                                {"silicon", 165e9, 2330},
                                {"beryllium", 287e9, 1850},
                                {"diamond", 1050e9, 3520}};

struct Set {
  const char *length, *name;
  double kg, m, s;
};

const std::vector<Set> sets{{"mm", "t mm s", 1e3, 1e-3, 1},
                            {"mm", "kg mm ms", 1, 1e-3, 1e-3},
                            {"mm", "g mm ms", 1e-3, 1e-3, 1e-3},
                            {"mm", "kg mm s", 1, 1e-3, 1},
                            {"mm", "mg mm ms", 1e-6, 1e-3, 1e-3},
                            {"mm", "g mm us", 1e-3, 1e-3, 1e-6},
                            {"mm", "mg mm us", 1e-6, 1e-3, 1e-6}, // GPa and g/cm³, times in µs
                            {"m", "SI", 1, 1, 1},
                            {"m", "t m s", 1e3, 1, 1},
                            {"cm", "g cm s", 1e-3, 1e-2, 1},
                            {"cm", "g cm us", 1e-3, 1e-2, 1e-6},
                            {"cm", "kg cm s", 1, 1e-2, 1},
                            {"in", "lbf s2/in", 175.126835, 0.0254, 1},
                            {"inch", "lbf s2/in", 175.126835, 0.0254, 1},
                            {"ft", "slug ft s", 14.593903, 0.3048, 1},
                            {"um", "kg um s", 1, 1e-6, 1}};

TEST(UnitCheck, IsSilentForRealSolidsInEveryConsistentSet) {
  for (const Set& set : sets)
    for (const Solid& solid : solids) {
      const double E = solid.E / (set.kg / (set.m * set.s * set.s)), rho = solid.rho / (set.kg / std::pow(set.m, 3));
      EXPECT_FALSE(unit_warning(set.length, E, rho))
          << solid.name << " in " << set.name << ": " << unit_warning(set.length, E, rho).value_or("");
    }
}

TEST(UnitCheck, IsSilentWithoutALengthUnitThatItKnows) {
  EXPECT_FALSE(unit_warning("unspecified", 210e9, 7850));
  EXPECT_FALSE(unit_warning("span", 210e9, 7850));
}

struct MixUp {
  const char* length;
  double E, rho;
  std::vector<std::string> words; ///< what the warning has to say
};

TEST(UnitCheck, WarnsOfTypicalMixUpsAndGivesTheNumbersThatWereMeant) {
  const std::vector<std::string> steel_in_mm{"E = 210000, rho = 7.85e-09", "E = 210, rho = 7.85e-06"},
      steel_in_m{"E = 2.1e+11, rho = 7850"};
  const std::vector<MixUp> mix_ups{{"mm", 210e9, 7850, steel_in_mm},    // SI
                                   {"mm", 210e3, 7850, steel_in_mm},    // MPa, kg/m³
                                   {"mm", 210, 7850, steel_in_mm},      // GPa, kg/m³
                                   {"mm", 210e9, 7.85e-6, steel_in_mm}, // Pa, kg/mm³
                                   {"mm", 210e9, 7.85e-9, steel_in_mm}, // Pa, t/mm³
                                   {"mm", 210, 7.85e-9, steel_in_mm},   // GPa, t/mm³
                                   {"mm", 210e3, 7.85e-6, steel_in_mm}, // MPa, kg/mm³
                                   {"mm", 210e3, 7.85, steel_in_mm},    // MPa, g/cm³
                                   {"m", 210e3, 7850, steel_in_m},      // MPa
                                   {"m", 210, 7850, steel_in_m},        // GPa
                                   {"m", 210e9, 7.85, steel_in_m},      // g/cm³
                                   {"m", 210e3, 7.85e-9, steel_in_m},   // t-mm-s
                                   {"m", 210, 7.85e-6, steel_in_m},     // kg-mm-ms
                                   {"mm", 70e9, 2700, {"E = 70000, rho = 2.7e-09"}},
                                   {"mm", 70, 2.7e-9, {"E = 70000, rho = 2.7e-09"}},
                                   {"mm", 70e3, 2.7e-6, {"E = 70000, rho = 2.7e-09"}},
                                   {"mm", 114e3, 4.43e-6, {"E = 114000, rho = 4.43e-09"}},
                                   {"mm", 120, 8.96e-9, {"E = 120000, rho = 8.96e-09"}},
                                   {"mm", 30, 2.4e-9, {"E = 30000, rho = 2.4e-09"}},
                                   {"mm", 5e6, 1100, {"t/mm³"}},        // rubber in SI
                                   {"mm", 50e6, 60, {"t/mm³"}},         // foam in SI
                                   {"m", 50, 6e-11, {"Pa, kg/m³"}},     // foam in t-mm-s
                                   {"in", 30e6, 0.284, {"lbf s²/in⁴"}}, // pounds of weight as mass
                                   {"in", 210e9, 7850, {"lbf s²/in⁴"}},
                                   {"cm", 210e9, 7850, {"g, cm, s"}}};
  for (const MixUp& m : mix_ups) {
    const auto warning = unit_warning(m.length, m.E, m.rho);
    ASSERT_TRUE(warning) << m.length << " E " << m.E << " rho " << m.rho;
    for (const std::string& word : m.words) EXPECT_NE(warning->find(word), std::string::npos) << *warning;
  }
}

TEST(UnitCheck, TakesTheModulusOfIsotropicMaterials) {
  EXPECT_NEAR(modulus_of(isotropic(210, 0.3, 1)), 210, 1e-10);
}

} // namespace
} // namespace iga::solve
