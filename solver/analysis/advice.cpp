#include "solver/analysis/advice.hpp"

#include "solver/space/span_advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

std::string numerical_advice(const RunSettings& run, const TrimmedModel& model) {
  std::vector<std::string> changes;
  if (!extends(run.light.remedy)) changes.push_back("--light-functions degree-p (functions on slivers follow others)");
  if (run.mass != MassType::Consistent && run.analysis == Analysis::Eigen) changes.push_back("--mass consistent");
  const std::string finer = span_advice(model);
  const std::string spans =
      !finer.empty() ? "the part is thin for its spans: " + finer
                     : fmt::format("make the model with smaller spans (now {:.3g}), or a lower degree (now {})",
                                   fmt::join(model.grid.span_size(), " × "), fmt::join(model.grid.degree(), " "));
  return changes.empty() ? spans : fmt::format("try {}; or {}", fmt::join(changes, ", "), spans);
}

} // namespace iga::solve
