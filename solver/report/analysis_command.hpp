// What the user asked of eigen, timestep or static, and how the answer is shown.
#pragma once

#include "solver/analysis/run_settings.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

/// How a report reaches the user. `json` prints one JSON object, `quiet` nothing but errors.
enum class ReportStyle { Text, Json, Quiet };

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

} // namespace iga::solve
