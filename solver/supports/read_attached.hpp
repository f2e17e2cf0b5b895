// [[spring]] and [[added_mass]] of a run file: what is attached to the part.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/supports/added_mass.hpp"
#include "solver/supports/spring.hpp"

namespace iga::solve {

/// The keys are listed in README.md. @throws InputError with file and line for values that make no sense
std::vector<Spring> read_springs(io::SettingsTable& root);
std::vector<AddedMass> read_masses(io::SettingsTable& root);

/// For SettingsTable::expect_only.
std::vector<io::TableKeys> attached_keys();

} // namespace iga::solve
