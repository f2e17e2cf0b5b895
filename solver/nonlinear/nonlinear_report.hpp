// What a nonlinear run says at its end.
#pragma once

#include "solver/nonlinear/nonlinear_outputs.hpp"
#include "solver/report/analysis_report.hpp"

namespace iga::solve {

struct NonlinearOutcome {
  const NonlinearRun& run;
  const NonlinearStatics& statics;
  const NonlinearOutputs& outputs;
  const std::vector<StepReport>& steps; ///< of this run; a restart leaves out those before
  const Timings& timings;
  const std::vector<std::string>& findings;
  const std::vector<std::string>& warnings;
};

/// What the steps should be warned of: points below min_volume_ratio, tangents that are not positive definite, deep
/// contact. @param span_size  smallest side, length
std::vector<std::string> step_warnings(const NonlinearRun& run, double span_size, const std::vector<StepReport>& steps);

std::string nonlinear_text(const NonlinearOutcome& outcome);
std::string nonlinear_json(const NonlinearOutcome& outcome);

} // namespace iga::solve
