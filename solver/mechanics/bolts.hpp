// Tightened bolts: a shank is shortened about a plane across it until it bears a given force.
#pragma once

#include "format/io/settings_reader.hpp"
#include "format/model/results.hpp"
#include "solver/mechanics/initial_strain.hpp"

#include <optional>
#include <string>

namespace iga::solve {

/// One of [[bolt]].
struct Bolt {
  std::string name;
  std::string body;             ///< that the shank belongs to; empty: the only body that has material there
  Point3 point{}, axis{};       ///< on the plane, length; its unit normal, along the shank
  double force = 0;             ///< tension in the shank when bolts alone act
  std::optional<double> length; ///< of shank that is shortened, half to either side; none: four spans
  std::optional<Box3> box;      ///< what lies in the plane outside of it is another's
};

/// Keys of the tables, for SettingsTable::expect_only.
std::vector<io::TableKeys> bolt_keys();
/// @throws InputError with file and line for values that make no sense
std::vector<Bolt> read_bolts(io::SettingsTable& root);

/// The strain of a shank that is shortened by one length: ε₀ = ε(u₀) of the spline u₀ = -S(d) n, d the distance from
/// the plane, S a smooth step from 0 to 1 over `length`. A free shank takes it up without stress, to rounding; and -∫ σ
/// : ε₀ dV is the force that the shank bears: that of all its sections where nothing acts on its sides.
/// @param space  of the body; must outlive the field
std::shared_ptr<const StrainField> shortening(const Bolt& bolt, const SolutionSpace& space);

/// -∫ n · ε₀ n dV of that strain: the shank's section, length². @throws InputError where it has none
double shank_section(const Bolt& bolt, const StrainField& shortening, const TrimmedModel& model);

/// -∫ σ : ε₀ dV from the stress at the model's quadrature points.
double section_force(const StrainField& shortening, const TrimmedModel& model, const FieldSamples& fields);

} // namespace iga::solve
