// The restart file of an explicit run: every number that changes, bit for bit, and what it belongs to.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/explicit/integrator.hpp"

#include <filesystem>

namespace iga::solve {

struct RestartState {
  std::string version;           ///< of the program: another one may add in another order
  std::vector<InputFile> inputs; ///< the run file first, then models, tools, curves; paths as given
  std::vector<StartStep> limits; ///< per body
  IntegratorState state;
  std::vector<double> sums;                                    ///< of the time series
  std::int64_t rows = 0;                                       ///< of the time series that were written
  std::int64_t fields = 0;                                     ///< steps of fields likewise
  std::int64_t next_row = 0, next_field = 0, next_restart = 0; ///< numbers of the outputs to come
};

/// out.h5 → out_restart.h5.
std::filesystem::path restart_path(const std::filesystem::path& results);

/// Replaces an older one; the file appears whole or not at all. @throws InputError with the system's reason
void write_restart(const std::filesystem::path& path, const RestartState& restart);

/// @throws InputError for a missing file, FormatError for one that is no intact restart file
RestartState read_restart(const std::filesystem::path& path);

/// Holds the files of a run against those that the restart file remembers. A run file that changed is told, all others
/// must be the same. @param version  of this program. @returns warnings
/// @throws InputError naming the file that changed, the version that differs
std::vector<std::string> check_restart(const RestartState& restart, const std::vector<InputFile>& inputs,
                                       const std::filesystem::path& path, const std::string& version);

} // namespace iga::solve
