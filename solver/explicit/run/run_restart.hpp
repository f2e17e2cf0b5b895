// The restart file of an explicit run: every number that changes, bit for bit, and what it belongs to.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "solver/explicit/run/run_file.hpp"

#include <filesystem>

namespace iga::solve {

struct RestartState {
  std::string version;           ///< of the program: another one may add in another order
  std::vector<InputFile> inputs; ///< the run file first, then models, tools, curves; paths as given
  struct Setting {
    std::string path, value; ///< io::SettingsEntry
    bool operator==(const Setting&) const = default;
  };
  std::vector<Setting> settings; ///< settings_to_keep of the run that is computed
  std::vector<StartStep> limits; ///< per body
  IntegratorState state;
  std::vector<double> sums; ///< of the time series
  std::int64_t rows = 0;    ///< of the time series that were written
  std::int64_t fields = 0;  ///< steps of fields likewise
};

/// The run file's values; long ones, such as curves, by their SHA-256.
std::vector<RestartState::Setting> settings_to_keep(const ExplicitRun& run);

/// out.h5 → out_restart.h5.
std::filesystem::path restart_path(const std::filesystem::path& results);

/// Replaces an older one; the file appears whole or not at all. @throws InputError with the system's reason
void write_restart(const std::filesystem::path& path, const RestartState& restart);

/// @throws InputError for a missing file, FormatError for one that is no intact restart file
RestartState read_restart(const std::filesystem::path& path);

/// Holds a run against the one that the restart file was written by. Only [time], [energy], [[stop]] and [output]
/// (without subdivide, the mesh of the fields) may differ, which is told; all else of the run file and the contents of
/// all other files must be the same.
/// @param inputs   the run file first, then run.inputs, with their SHA-256
/// @param version  of this program
/// @returns warnings
/// @throws InputError naming the key with what was found when the run began and now, the file that changed, the version
///         that differs
std::vector<std::string> check_restart(const RestartState& restart, const ExplicitRun& run,
                                       const std::vector<InputFile>& inputs, const std::filesystem::path& path,
                                       const std::string& version);

} // namespace iga::solve
