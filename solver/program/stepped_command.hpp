// What igasolve explicit and nonlinear are asked for.
#pragma once

#include "solver/program/commands.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

/// What the analyses that go on in steps are asked for on the command line.
struct SteppedCommand {
  std::filesystem::path run_file;
  std::optional<std::filesystem::path> output; ///< in the place of the run file's
  ReportStyle style = ReportStyle::Text;
  bool force = false;
  bool restart = false; ///< go on with the restart file beside the results
  std::optional<int> threads;
  std::string text; ///< as typed, for the provenance
};

} // namespace iga::solve
