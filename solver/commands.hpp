// The commands of igasolve: each takes what the user asked for and returns the exit code; errors are thrown.
#pragma once

#include <filesystem>

namespace iga::solve {

/// How a report reaches the user. `json` prints one JSON object, `quiet` nothing but errors.
enum class ReportStyle { Text, Json, Quiet };

/// Exit codes of both tools.
enum ExitCode { success = 0, our_bug = 1, bad_input = 2, bad_format = 3, no_convergence = 4 };

struct ModelCommand {
  std::filesystem::path model;
  ReportStyle style = ReportStyle::Text;
};

/// Prints what a sound model file holds. @throws InputError, FormatError
int run_info(const ModelCommand& command);

/// Prints every problem of a model file, or that there is none; bad_format where there are problems. @throws InputError
int run_check(const ModelCommand& command);

} // namespace iga::solve
