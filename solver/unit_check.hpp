// Do modulus and density fit the length unit of the model? Units are never converted, only held against what solids
// have.
#pragma once

#include "solver/material.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace iga::solve {

/// Young's modulus; of anisotropic materials the geometric mean along x, y and z. Force/length².
double modulus_of(const ElasticMaterial& material);

/// A warning where no consistent set of units in use with this length unit makes a solid of these numbers: density
/// 1 … 25 000 kg/m³, modulus 100 Pa … 1.5 TPa, above 2 500 kg/m³ at least 1 GPa, wave speed √(E/ρ) 10 … 20 000 m/s (the
/// charts of Ashby, Materials Selection in Mechanical Design, chapter 4). It names the units the numbers were probably
/// meant in and what they are in the model's. Nothing for a length unit that is not known.
/// @param E, rho  as given, force/length² and mass/length³
std::optional<std::string> unit_warning(std::string_view length_unit, double E, double rho);

} // namespace iga::solve
