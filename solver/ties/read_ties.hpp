// [[ties]] of a run file.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/ties/tie.hpp"

namespace iga::solve {

/// The keys are listed in README.md, ties. @throws InputError with file and line for values that make no sense
std::vector<Tie> read_ties(io::SettingsTable& root);
/// For SettingsTable::expect_only.
std::vector<io::TableKeys> tie_keys();

} // namespace iga::solve
