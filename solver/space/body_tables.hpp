// What [[bodies]] of a run file says whatever the analysis: a model, its name and its place.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/space/placement.hpp"

#include <filesystem>
#include <string>

namespace iga::solve {

struct BodyFile {
  std::string name;
  std::string where; ///< "file:line" of the model, opens messages about what only the model can tell
  std::filesystem::path model;
  Placement place; ///< of the model in the run

  bool operator==(const BodyFile&) const = default;
};

/// @param names  of the bodies before it
/// @throws InputError for a model that is missing or not there, and a name that is taken
BodyFile read_body_file(io::SettingsTable& table, const std::vector<std::string>& names);
/// For SettingsTable::expect_only.
std::vector<io::TableKeys> body_file_keys();

} // namespace iga::solve
