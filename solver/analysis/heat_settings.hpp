// [[heat]] of a run file: where heat enters and leaves a body, for `igasolve heat`.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/space/surface_region.hpp"

#include <string>
#include <vector>

namespace iga::solve {

enum class HeatKind {
  Temperature, ///< value: temperature of a region, held weakly by Nitsche's method
  Flux,        ///< value: power/length² into the body through a region
  Power,       ///< value: power into the body, spread evenly over a region
  Convection,  ///< value: film coefficient h, power/(length² temperature); flux h (ambient - T) into the body
  Source,      ///< value: power/length³ everywhere in the body
};
const char* name_of(HeatKind kind);

struct HeatBoundary {
  std::string name;
  HeatKind kind = HeatKind::Temperature;
  RegionChoice region; ///< of all but Source
  double value = 0;
  double ambient = 0; ///< temperature, of Convection
};

/// Keys of the tables, for SettingsTable::expect_only.
std::vector<io::TableKeys> heat_keys();
/// @throws InputError with file and line for values that make no sense
std::vector<HeatBoundary> read_heat(io::SettingsTable& root);

} // namespace iga::solve
