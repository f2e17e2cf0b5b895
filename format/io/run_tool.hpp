// The one place that turns what went wrong into a message and an exit code, for both tools.
#pragma once

#include <functional>
#include <string>

namespace iga::io {

/// Exit codes that scripts may rely on.
enum ExitCode : int { exit_done = 0, exit_our_bug = 1, exit_input = 2, exit_format = 3, exit_numerical = 4 };

/// Runs `work` and returns its result, or the exit code of what it threw after printing "name: error: …" to stderr:
/// InputError 2, FormatError 3, NumericalError 4, Interrupted 128 + the signal's number (SIGHUP 129, SIGINT 130,
/// SIGQUIT 131, SIGTERM 143), a report whose reader has gone 141, a failed system call or exhausted memory 2, anything
/// else 1.
int run_tool(const std::string& name, const std::function<int()>& work);

} // namespace iga::io
