// Materials by name, and the consistent sets of units in which their numbers can be given.
#pragma once

#include "solver/mechanics/material.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace iga::solve {

/// A consistent set of units by its mass, length and time in SI.
struct UnitSystem {
  std::string_view name; ///< "t-mm-s"
  std::string_view length;
  double kg, m, s;
  std::string_view stress, density; ///< what force/length² and mass/length³ are called: "MPa", "t/mm³"
  double pascal() const { return kg / (m * s * s); }
  double kg_per_m3() const { return kg / (m * m * m); }
  double watt_per_m_k() const { return kg * m / (s * s * s); } ///< kelvin is kelvin in all of them
};

/// The set that is asked for, "t-mm-s", "kg-mm-ms" or "SI"; without a wish the first one of these with the model's
/// length.
/// @param model  how messages call the model: "part.h5"
/// @throws InputError for an unknown name, for one whose length is not the model's, for a model without a length unit,
/// and for lengths that none of the sets has
const UnitSystem& choose_units(const std::optional<std::string>& wish, std::string_view length_unit,
                               const std::string& model);

/// Isotropic and linear elastic; E in Pa, rho in kg/m³, expansion in 1/K, conductivity in W/(m K).
struct NamedMaterial {
  std::string name;   ///< as the table has it
  std::string source; ///< where the numbers are from; may be empty
  double E = 0, nu = 0, rho = 0;
  std::optional<double> expansion = {}, conductivity = {};
  std::optional<double> yield = {}; ///< yield or 0.2 % proof strength, Pa
};

/// Of the program's own table (samples/materials.toml), or of a file in the same form; the case of letters does not
/// matter.
/// @throws InputError for an unknown name, with all names; for a file with numbers that are those of no solid in SI
NamedMaterial find_material(const std::string& name, const std::optional<std::filesystem::path>& file);

/// What a report says about a material.
struct MaterialWords {
  std::string name, source;          ///< empty where the numbers were given
  std::optional<double> E, nu, rho;  ///< as the analysis has them; no E and nu of anisotropic materials
  const UnitSystem* units = nullptr; ///< null: those of the model, which only its maker knows
  std::optional<double> expansion = {}, conductivity = {};
  std::optional<double> yield = {}; ///< strength that safety factors are taken against, force/length²
};
/// "steel: E = 210000 MPa, nu = 0.3, rho = 7.85e-09 t/mm³ (EN 1993-1-1)", and where units and rho are known, in a
/// second line, "the part has a mass of 1.234 kg".
std::string material_text(const MaterialWords& words, double volume);
/// Mass in kg; nothing where units or density are not known. @param volume  length³
std::optional<double> mass_in_kg(const MaterialWords& words, double volume);

} // namespace iga::solve
