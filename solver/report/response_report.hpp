// What harmonic, random and transient analyses report and write alike.
#pragma once

#include "solver/report/analysis_report.hpp"
#include "solver/response/response_tables.hpp"

namespace iga::solve {

/// Warns of what the superposition leaves out. @param highest  of the excitation, cycles/time; 0: not known
void warn_of_range(AnalysisRun& run, const ResponseSystem& system, double highest);

/// Models, supports, modes and residual vectors, damping, what excites the part.
void add_response(TextReport& report, const AnalysisRun& run, const ResponseSystem& system);
void add_response(io::JsonObject& report, const AnalysisRun& run, const ResponseSystem& system);

/// Largest answers of the probes. @param where  "at frequency", "at time"
void add_peaks(TextReport& report, const ResponseSystem& system, const std::vector<ProbePeaks>& peaks,
               const char* where);
std::vector<io::JsonObject> json_of(const ResponseSystem& system, const std::vector<ProbePeaks>& peaks,
                                    const char* where);
void add_rms(TextReport& report, const ResponseSystem& system, const std::vector<ProbeRms>& rms);
std::vector<io::JsonObject> json_of(const ResponseSystem& system, const std::vector<ProbeRms>& rms);

} // namespace iga::solve
