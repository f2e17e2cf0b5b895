// The command line of igasolve: which command, with which settings.
#pragma once

#include "solver/program/commands.hpp"
#include "solver/program/explicit_command.hpp"
#include "solver/program/nonlinear_command.hpp"
#include "solver/report/analysis_command.hpp"

#include <optional>
#include <variant>

namespace iga::solve {

struct InfoCommand : ModelCommand {};
using Command =
    std::variant<InfoCommand, CheckCommand, ExportCommand, AnalysisCommand, ExplicitCommand, NonlinearCommand>;

/// @returns nothing where --help or --version has been answered
/// @throws InputError for a usage error or a run file that cannot be read
std::optional<Command> parse_command_line(int argc, const char* const* argv);

} // namespace iga::solve
