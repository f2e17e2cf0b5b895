// igasolve nonlinear: the run from its file to results, restart file and report.
#pragma once

#include "solver/program/commands.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

struct NonlinearCommand {
  std::filesystem::path run_file;
  std::optional<std::filesystem::path> output; ///< in the place of the run file's
  ReportStyle style = ReportStyle::Text;
  bool force = false;
  bool restart = false; ///< go on with the restart file beside the results
  std::optional<int> threads;
  std::string text; ///< as typed, for the provenance
};

/// @returns exit_done, or 128 + the number of the signal that ended the run: results and a restart file are there then
/// @throws InputError, FormatError; NumericalError where no equilibrium was found, with the steps so far written
int run_nonlinear(const NonlinearCommand& command);

} // namespace iga::solve
