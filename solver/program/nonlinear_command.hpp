// igasolve nonlinear: the run from its file to results, restart file and report.
#pragma once

#include "solver/program/stepped_command.hpp"

namespace iga::solve {

struct NonlinearCommand : SteppedCommand {};

/// @returns exit_done, or 128 + the number of the signal that ended the run: results and a restart file are there then
/// @throws InputError, FormatError; NumericalError where no equilibrium was found, with the steps so far written
int run_nonlinear(const NonlinearCommand& command);

} // namespace iga::solve
