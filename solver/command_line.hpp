// The command line of igasolve: which command, with which settings.
#pragma once

#include "solver/commands.hpp"
#include "solver/explicit/explicit_command.hpp"
#include "solver/run_settings.hpp"

#include <optional>
#include <variant>

namespace iga::solve {

/// An analysis with everything that the command line and the run file say.
struct AnalysisCommand {
  std::filesystem::path run_file; ///< empty where the model was given
  TypedRun typed;                 ///< file and flags together
  Analysis analysis = Analysis::Eigen;
  ReportStyle style = ReportStyle::Text;
  bool force = false;
  std::optional<int> threads;
  std::string text; ///< as typed, for the provenance
};

struct InfoCommand : ModelCommand {};
struct CheckCommand : ModelCommand {};
using Command = std::variant<InfoCommand, CheckCommand, ExportCommand, AnalysisCommand, ExplicitCommand>;

/// @returns nothing where --help or --version has been answered
/// @throws InputError for a usage error or a run file that cannot be read
std::optional<Command> parse_command_line(int argc, const char* const* argv);

} // namespace iga::solve
