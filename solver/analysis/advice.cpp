#include "solver/analysis/advice.hpp"

#include "solver/space/span_advice.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

std::string span_changes(const TrimmedModel& model) {
  const std::string finer = span_advice(model);
  return !finer.empty() ? "the part is thin for its spans: " + finer
                        : fmt::format("make the model with smaller spans (now {:.3g}), or a lower degree (now {})",
                                      fmt::join(model.grid.span_size(), " × "), fmt::join(model.grid.degree(), " "));
}

} // namespace

std::string numerical_advice(const RunSettings& run, std::span<const TrimmedModel> models) {
  std::vector<std::string> changes;
  const std::vector<RunBody> bodies = bodies_of(run);
  if (std::any_of(bodies.begin(), bodies.end(), [](const RunBody& b) { return !extends(b.light.remedy); }))
    changes.push_back("--light-functions degree-p (functions on slivers follow others)");
  if (run.mass != MassType::Consistent && run.analysis == Analysis::Eigen) changes.push_back("--mass consistent");
  std::string spans;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    spans += (b == 0 ? "" : "; ") + (bodies.size() > 1 ? fmt::format("body '{}': ", bodies[b].file.name) : "") +
             span_changes(models[b]);
  return changes.empty() ? spans : fmt::format("try {}; or {}", fmt::join(changes, ", "), spans);
}

} // namespace iga::solve
