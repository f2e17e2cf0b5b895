// Several solids in one file: a model for each, in a folder, and a run file to fill in.
#pragma once

#include "preprocessor/program/pipeline.hpp"

namespace iga::prep {

struct AssemblyReport {
  std::vector<PrepReport> models;
  std::filesystem::path run_file;
  bool run_file_kept = false; ///< one stood there already: it may be filled in, so it stays
};

/// Models of all solids of a CAD file, or of all bodies of a surface, in the folder settings.output (made where it is
/// missing), and run.toml there: bodies with their places, materials left open.
/// @throws InputError, NumericalError as run_pipeline, naming the solid; models made until then stay
AssemblyReport run_assembly(const Settings& settings, const RunInfo& run, io::Progress& progress);

} // namespace iga::prep
