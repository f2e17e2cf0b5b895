// What helps where an analysis does not reach its tolerance.
#pragma once

#include "solver/analysis/run_settings.hpp"

namespace iga::solve {

/// What to change in a run that did not reach its tolerance: never what it does already.
std::string numerical_advice(const RunSettings& run, std::span<const TrimmedModel> models);

} // namespace iga::solve
