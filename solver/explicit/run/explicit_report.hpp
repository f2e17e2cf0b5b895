// What `igasolve explicit` prints when a run has ended.
#pragma once

#include "solver/explicit/run/explicit_loop.hpp"
#include "solver/report/analysis_report.hpp"

namespace iga::solve {

struct ExplicitOutcome {
  const ExplicitScene& scene;
  const SeriesRecorder& recorder;
  const RunOutputs& outputs;
  const ExplicitLoop& loop;
  const Timings& timings;
  const std::vector<std::string>& warnings;
};

std::string explicit_text(const ExplicitOutcome& outcome);
std::string explicit_json(const ExplicitOutcome& outcome);

} // namespace iga::solve
