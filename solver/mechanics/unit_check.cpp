#include "solver/mechanics/unit_check.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// A consistent set of units by its mass, length and time in SI.
struct UnitSet {
  const char* name;
  const char* length;
  double kg, m, s;
  double pascal() const { return kg / (m * s * s); }
  double density() const { return kg / (m * m * m); }
};

// The usual one for each length first: advice names it.
constexpr std::array<UnitSet, 23> unit_sets{{{"t, mm, s (N/mm², t/mm³)", "mm", 1e3, 1e-3, 1},
                                             {"kg, mm, ms (kN/mm², kg/mm³)", "mm", 1, 1e-3, 1e-3},
                                             {"g, mm, ms (N/mm², g/mm³)", "mm", 1e-3, 1e-3, 1e-3},
                                             {"kg, mm, s (kPa, kg/mm³)", "mm", 1, 1e-3, 1},
                                             {"g, mm, s (Pa, g/mm³)", "mm", 1e-3, 1e-3, 1},
                                             {"mg, mm, ms (kPa, mg/mm³)", "mm", 1e-6, 1e-3, 1e-3},
                                             {"g, mm, µs (TPa, g/mm³)", "mm", 1e-3, 1e-3, 1e-6},
                                             {"mg, mm, µs (GPa, mg/mm³)", "mm", 1e-6, 1e-3, 1e-6},
                                             {"kg, m, s (Pa, kg/m³)", "m", 1, 1, 1},
                                             {"t, m, s (kPa, t/m³)", "m", 1e3, 1, 1},
                                             {"kt, m, s (MPa, kt/m³)", "m", 1e6, 1, 1},
                                             {"g, cm, s (0.1 Pa, g/cm³)", "cm", 1e-3, 1e-2, 1},
                                             {"g, cm, ms (0.1 MPa, g/cm³)", "cm", 1e-3, 1e-2, 1e-3},
                                             {"g, cm, µs (0.1 TPa, g/cm³)", "cm", 1e-3, 1e-2, 1e-6},
                                             {"kg, cm, s (100 Pa, kg/cm³)", "cm", 1, 1e-2, 1},
                                             {"kg, cm, ms (0.1 GPa, kg/cm³)", "cm", 1, 1e-2, 1e-3},
                                             {"N s²/cm, cm, s (N/cm², N s²/cm⁴)", "cm", 1e2, 1e-2, 1},
                                             {"lbf s²/in, in, s (psi, lbf s²/in⁴)", "in", 175.126835, 0.0254, 1},
                                             {"klbf s²/in, in, s (ksi, klbf s²/in⁴)", "in", 175126.835, 0.0254, 1},
                                             {"slug, ft, s (lbf/ft², slug/ft³)", "ft", 14.593903, 0.3048, 1},
                                             {"kg, µm, s (MPa, kg/µm³)", "µm", 1, 1e-6, 1},
                                             {"g, µm, ms (GPa, g/µm³)", "µm", 1e-3, 1e-6, 1e-3},
                                             {"ng, µm, µs (MPa, ng/µm³)", "µm", 1e-12, 1e-6, 1e-6}}};

struct Unit {
  const char* name;
  double si;
};
constexpr std::array<Unit, 7> moduli{
    {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"psi", 6894.757}, {"ksi", 6894757}, {"dyn/cm²", 0.1}}};
constexpr std::array<Unit, 6> densities{{{"kg/m³", 1},
                                         {"g/cm³", 1e3},
                                         {"kg/mm³", 1e9},
                                         {"t/mm³", 1e12},
                                         {"lb/in³", 27679.905},
                                         {"lbf s²/in⁴", 1.06868786e7}}};

double wave_speed(double E, double rho) {
  return std::sqrt(E / rho);
}

// Of a solid, in SI: the bounds of the header.
bool is_solid(double E, double rho) {
  constexpr double dense = 2300, dense_modulus = 1e9, light = 1000, light_speed = 7000;
  const double c = wave_speed(E, rho);
  return rho >= 10 && rho <= 25'000 && E >= 1000 && E <= 1.5e12 && c >= 10 && c <= 20'000 &&
         (rho <= dense || E >= dense_modulus) && (rho >= light || c <= light_speed);
}

} // namespace

std::string_view common_length_name(std::string_view label) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 19> others{{{"millimetre", "mm"},
                                                                                  {"millimeter", "mm"},
                                                                                  {"MM", "mm"},
                                                                                  {"metre", "m"},
                                                                                  {"meter", "m"},
                                                                                  {"M", "m"},
                                                                                  {"centimetre", "cm"},
                                                                                  {"centimeter", "cm"},
                                                                                  {"CM", "cm"},
                                                                                  {"inch", "in"},
                                                                                  {"inches", "in"},
                                                                                  {"\"", "in"},
                                                                                  {"IN", "in"},
                                                                                  {"foot", "ft"},
                                                                                  {"feet", "ft"},
                                                                                  {"FT", "ft"},
                                                                                  {"um", "µm"},
                                                                                  {"micron", "µm"},
                                                                                  {"micrometre", "µm"}}};
  for (const auto& [name, common] : others)
    if (label == name) return common;
  return label;
}

namespace {

struct Solid {
  double E, rho; // Pa, kg/m³
};
// What parts are made of most: steel, copper, titanium, aluminium, magnesium, concrete, laminates, plastics, wood,
// rubber, foam.
constexpr std::array<Solid, 14> common_solids{{{210e9, 7850},
                                               {120e9, 8960},
                                               {114e9, 4430},
                                               {70e9, 2700},
                                               {45e9, 1740},
                                               {30e9, 2400},
                                               {150e9, 1600},
                                               {40e9, 1900},
                                               {3e9, 1150},
                                               {0.5e9, 950},
                                               {11e9, 600},
                                               {3e6, 1100},
                                               {50e6, 60},
                                               {3e6, 20}}};

// How far a solid is from the nearest common one: factors of the modulus, and of the density, which varies less.
double rarity(double E, double rho) {
  constexpr double weight_of_density = 3;
  double least = HUGE_VAL;
  for (const Solid& s : common_solids)
    least = std::min(least, std::hypot(std::log(E / s.E), weight_of_density * std::log(rho / s.rho)));
  return least;
}

// The units in which the numbers make the likeliest solid.
std::string meant(const std::vector<const UnitSet*>& sets, double E, double rho) {
  double least = HUGE_VAL;
  const Unit *modulus = nullptr, *density = nullptr;
  for (const Unit& e : moduli)
    for (const Unit& r : densities) {
      const double rare = rarity(E * e.si, rho * r.si);
      if (!is_solid(E * e.si, rho * r.si) || rare >= least) continue;
      least = rare;
      modulus = &e;
      density = &r;
    }
  if (!modulus) return "check both numbers";
  std::string text = fmt::format("if E is in {} and rho in {}, give", modulus->name, density->name);
  for (std::size_t k = 0; k < std::min<std::size_t>(2, sets.size()); ++k)
    text += fmt::format("{} E = {:.6g}, rho = {:.6g} in {}", k ? " or" : "", E * modulus->si / sets[k]->pascal(),
                        rho * density->si / sets[k]->density(), sets[k]->name);
  return text;
}

} // namespace

double modulus_of(const ElasticMaterial& material) {
  const Eigen::Matrix<double, 6, 6> compliance = material.C.inverse();
  return std::cbrt(1 / (compliance(0, 0) * compliance(1, 1) * compliance(2, 2)));
}

std::optional<std::string> unit_warning(std::string_view length_unit, double E, double rho) {
  std::vector<const UnitSet*> sets;
  for (const UnitSet& set : unit_sets)
    if (common_length_name(length_unit) == set.length) sets.push_back(&set);
  if (sets.empty() || std::any_of(sets.begin(), sets.end(), [&](const UnitSet* set) {
        return is_solid(E * set->pascal(), rho * set->density());
      }))
    return std::nullopt;
  const UnitSet& usual = *sets.front();
  const double E_si = E * usual.pascal(), rho_si = rho * usual.density();
  return fmt::format(
      "E = {:.6g} and rho = {:.6g} are those of no solid in a consistent set of units with lengths in {}: "
      "in {} they are {:.3g} GPa and {:.3g} kg/m³, a wave speed of {:.3g} m/s (solids: 10 to 20000); {}",
      E, rho, length_unit, usual.name, E_si / 1e9, rho_si, wave_speed(E_si, rho_si), meant(sets, E, rho));
}

} // namespace iga::solve
