// igasolve explicit: the run from its file to results, restart file and report.
#pragma once

#include "solver/program/stepped_command.hpp"

namespace iga::solve {

struct ExplicitCommand : SteppedCommand {
  bool profile = false; ///< measure CPU time by phase, inside and outside of parallel loops
};

/// @returns exit_done, or 128 + the number of the signal that ended the run: results and a restart file are there then
/// @throws InputError, FormatError; NumericalError where the run blew up, with the results so far written
int run_explicit(const ExplicitCommand& command);

} // namespace iga::solve
