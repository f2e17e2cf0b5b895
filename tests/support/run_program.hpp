// Runs one of our executables as a user would: in a folder of its own, with arguments, and tells what came out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace iga::test {

struct ProgramRun {
  int exit_code = -1; ///< 128 + the signal's number where a signal ended it
  std::string out, err;
};

struct RunOptions {
  std::filesystem::path folder;            ///< working directory
  std::optional<std::string> signal_after; ///< send `signal` once this text has appeared on stderr
  int signal = 0;
  std::optional<unsigned long> file_size_limit; ///< bytes; longer writes fail as on a full disk
};

ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const RunOptions& options);

/// Names of all entries of a folder, sorted.
std::vector<std::string> entries(const std::filesystem::path& folder);

} // namespace iga::test
