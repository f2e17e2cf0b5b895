// Do modulus and density fit the length unit of the model? Units are never converted, only held against what solids
// have.
#pragma once

#include "solver/mechanics/material.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace iga::solve {

/// "mm" for "millimetre", "MM", …; other labels as they are.
std::string_view common_length_name(std::string_view label);

/// Young's modulus; of anisotropic materials the geometric mean along x, y and z. Force/length².
double modulus_of(const ElasticMaterial& material);

/// A warning where no consistent set of units in use with this length unit makes a solid of these numbers. Solids
/// have (the charts of Ashby, Materials Selection in Mechanical Design, chapter 4)
///   density 10 … 25 000 kg/m³, modulus 1 kPa … 1.5 TPa, wave speed √(E/ρ) 10 … 20 000 m/s;
///   above 2 300 kg/m³ at least 1 GPa: what is denser than clay and polymers is rock, ceramic or metal;
///   below 1 000 kg/m³ a wave speed of at most 7 000 m/s: foams, woods and lattices hold less of what they are made of.
/// It names the units the numbers were probably meant in and what they are in the model's. Nothing for a length unit
/// that is not known, nor for a mix-up that makes another solid of a consistent set: polyamide given in MPa and kg/mm³
/// (3000, 1.13e-6) is a rubber in kg, mm, s.
/// @param E, rho  as given, force/length² and mass/length³
std::optional<std::string> unit_warning(std::string_view length_unit, double E, double rho);

} // namespace iga::solve
