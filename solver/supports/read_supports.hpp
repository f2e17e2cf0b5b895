// [[support]], [[load]], [[case]], [[probe]] and [temperature] of a run file.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/mechanics/bolts.hpp"
#include "solver/mechanics/loads.hpp"
#include "solver/mechanics/temperature.hpp"
#include "solver/output/recover.hpp"
#include "solver/supports/boundary.hpp"

namespace iga::solve {

/// One of [[case]]: loads that act together, each times a factor.
struct LoadCase {
  std::string name;
  std::vector<double> factors; ///< by load of the run; 0 where the case does not name it
  std::vector<double> bolts;   ///< by bolt of the run, likewise
  double temperature = 1;      ///< factor of the thermal strain
  double prescribed = 1;       ///< factor of the displacements that supports prescribe
};

/// What a static run is asked for beyond what every run has.
struct StaticSettings {
  std::vector<Load> loads;
  std::vector<Probe> probes;
  std::optional<TemperatureSettings> temperature = {};
  std::vector<Bolt> bolts = {};
  std::vector<LoadCase> cases = {}; ///< empty: one, with all that is there
  bool inertia_relief = false;      ///< a free part: its own inertia balances the loads
};

/// The keys are listed in README.md, run file. Unknown keys are refused by the root table afterwards.
/// @throws InputError with file and line for values that make no sense
std::vector<Support> read_supports(io::SettingsTable& root);
StaticSettings read_static_settings(io::SettingsTable& root);

/// Keys of `table` and of the tables in it, for SettingsTable::expect_only: those that choose surface; lines and
/// points; those of a load.
std::vector<io::TableKeys> region_keys(const std::string& table);
std::vector<io::TableKeys> place_keys(const std::string& table);
std::vector<io::TableKeys> load_keys(const std::string& table);
/// Those of [[support]], [[load]] and [[probe]], all of them.
std::vector<io::TableKeys> static_keys();

/// Keys of [[case]]: those of its table `loads` are the names of the file's loads and bolts, and "temperature".
std::vector<io::TableKeys> case_keys(const io::SettingsTable& root);

/// One [[load]], `number` counted from 1 for its name where it has none.
Load read_load(io::SettingsTable& table, std::size_t number);
/// The keys that choose surface. @throws InputError where there are none
RegionChoice need_region(io::SettingsTable& table);
/// The same; nothing where there is no key.
std::optional<RegionChoice> region_if_given(io::SettingsTable& table);
/// curve, line, point or at: one of them at most.
PlaceChoice read_place(io::SettingsTable& table);
/// `rotation` or `rotate_axis_angle`; without them the part's axes.
Rotation read_frame(io::SettingsTable& table);
/// The same as need_region; no key at all means the whole surface.
RegionChoice region_or_all(io::SettingsTable& table);

} // namespace iga::solve
