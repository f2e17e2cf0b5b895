// What reports say about the loads under which a part vibrates or buckles.
#pragma once

#include "format/io/json_text.hpp"
#include "solver/analysis/preload.hpp"
#include "solver/report/analysis_report.hpp"

namespace iga::solve {

/// Loads with their resultants, largest displacement and stress, what the linear preload leaves out.
/// @param what  key of the lines: "preload"
void add_preload(TextReport& report, const char* what, const AnalysisRun& run, const BodySystem& system,
                 const Preload& preload);
/// The static state as igasolve static --json gives it, the largest strain, and the notes.
io::JsonObject json_of(const AnalysisRun& run, const BodySystem& system, const Preload& preload);

} // namespace iga::solve
