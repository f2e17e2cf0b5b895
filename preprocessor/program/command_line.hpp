// The command line of igaprep: flags and settings file → settings.
#pragma once

#include "preprocessor/program/settings.hpp"

#include <optional>

namespace iga::prep {

struct CommandLine {
  TypedSettings typed;                 ///< file and flags together
  std::filesystem::path settings_file; ///< empty where there is none
  std::optional<int> threads;
  bool force = false, quiet = false, json = false;
  bool list = false, list_edges = false; ///< what a CAD file holds, instead of a model
  std::string text;                      ///< as typed, for the provenance
};

/// @returns nothing where --help or --version has been answered
/// @throws InputError for a usage error
std::optional<CommandLine> parse_command_line(int argc, const char* const* argv);

} // namespace iga::prep
