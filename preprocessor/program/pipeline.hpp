// From a surface file to a written model: the stages in order, the gates between them, the reuse of what stands there.
#pragma once

#include "format/io/progress.hpp"
#include "preprocessor/program/part_source.hpp"
#include "preprocessor/program/report.hpp"
#include "preprocessor/program/settings.hpp"

namespace iga::prep {

/// How a run is recorded and whether it may replace what stands at the output.
struct RunInfo {
  std::string command_line;
  bool force = false;
  std::filesystem::path settings_file; ///< empty where there is none
};

/// Runs all stages and writes settings.output; where a file from the same input bytes, settings and version stands
/// there, does nothing but say so (PrepReport::reused).
/// @throws InputError, FormatError, NumericalError, io::Interrupted; nothing is written then, and what stood there
/// stays
/// @param part  the part, called at most once and not where the file stands already; without it the input file is read
PrepReport run_pipeline(const Settings& settings, const RunInfo& run, io::Progress& progress,
                        const std::function<Part()>& part = {});

/// Hash of the settings that affect data, together with the producer's version.
std::string settings_hash(const Settings& settings);

} // namespace iga::prep
