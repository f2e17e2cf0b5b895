// igasolve explicit: the run from its file to results, restart file and report.
#pragma once

#include "solver/program/commands.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

struct ExplicitCommand {
  std::filesystem::path run_file;
  std::optional<std::filesystem::path> output; ///< in the place of the run file's
  ReportStyle style = ReportStyle::Text;
  bool force = false;
  bool restart = false; ///< go on with the restart file beside the results
  std::optional<int> threads;
  std::string text; ///< as typed, for the provenance
};

/// @returns exit_done, or 128 + the number of the signal that ended the run: results and a restart file are there then
/// @throws InputError, FormatError; NumericalError where the run blew up, with the results so far written
int run_explicit(const ExplicitCommand& command);

} // namespace iga::solve
