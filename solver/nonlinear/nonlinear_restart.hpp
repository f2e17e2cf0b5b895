// The restart file of a nonlinear run: the last converged step, bit for bit, and what it belongs to.
#pragma once

#include "format/io/settings_reader.hpp"
#include "format/model/trimmed_model.hpp"
#include "solver/nonlinear/nonlinear_statics.hpp"

#include <filesystem>

namespace iga::solve {

struct NonlinearRestart {
  std::string version;                                       ///< of the program
  std::vector<InputFile> inputs;                             ///< NonlinearRun::inputs with their SHA-256
  std::vector<std::pair<std::string, std::string>> settings; ///< of the run file, those that may not change
  StaticState state;
  std::int64_t rows = 0; ///< of the time series and of the fields
};

/// Values of the run file without [nonlinear], [results] and output, which a restart may change.
std::vector<std::pair<std::string, std::string>> settings_to_keep(const NonlinearRun& run);

/// Replaces an older one; the file appears whole or not at all. @throws InputError with the system's reason
void write_restart(const std::filesystem::path& path, const NonlinearRestart& restart);
/// @throws InputError for a missing file, FormatError for one that is no intact restart file
NonlinearRestart read_nonlinear_restart(const std::filesystem::path& path);
/// @throws InputError naming the key, the file or the version that differs
void check_restart(const NonlinearRestart& restart, const NonlinearRestart& now, const std::filesystem::path& path);

} // namespace iga::solve
