#include "solver/analysis/solver_choice.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/free_memory.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double GiB = 1024.0 * 1024 * 1024;
// The direct solver is left alone where its factor takes less than this share of what is free.
constexpr double much_memory = 0.7;

} // namespace

SolverKind solver_kind(const std::string& word) {
  if (word == "auto") return SolverKind::Auto;
  if (word == "direct") return SolverKind::Direct;
  if (word == "multigrid") return SolverKind::Multigrid;
  throw InputError(fmt::format("solver: found \"{}\", expected \"auto\", \"direct\" or \"multigrid\"", word));
}

std::string text_of(const SolverReport& report) {
  std::string text = fmt::format("{} ({})", report.multigrid ? "multigrid" : "direct", report.reason);
  if (report.multigrid && !report.level_nodes.empty())
    text += fmt::format(": {} levels of {} … {} nodes, {} steps", report.level_nodes.size(), report.level_nodes.front(),
                        report.level_nodes.back(), report.steps);
  return text;
}

double estimated_factor_bytes(const NodePattern& pattern) {
  // Fitted to the foam part, p = 2 and 3, 14 500 … 158 000 unknowns.
  constexpr double share = 0.43, power = 1.3, work_space = 1.3;
  const auto nodes = static_cast<double>(pattern.num_nodes());
  const double per_row = (2 * static_cast<double>(pattern.num_pairs()) - nodes) / nodes;
  return 8 * work_space * share * per_row * std::pow(3 * nodes, power);
}

SolverReport choose_solver(SolverKind asked, const NodePattern& pattern, const std::string& obstacle) {
  SolverReport report;
  report.factor_estimate = estimated_factor_bytes(pattern);
  if (asked == SolverKind::Multigrid) {
    if (!obstacle.empty())
      throw InputError(fmt::format("solver = \"multigrid\": {}; use \"direct\" or \"auto\"", obstacle));
    report.multigrid = true;
    report.reason = "as asked";
    return report;
  }
  const std::int64_t unknowns = 3 * pattern.num_nodes();
  const bool tight = report.factor_estimate > much_memory * free_memory(), large = unknowns >= multigrid_from;
  if (asked == SolverKind::Direct)
    report.reason = "as asked";
  else if (!large && !tight)
    report.reason = fmt::format("fewer than {} unknowns", multigrid_from);
  else if (!obstacle.empty())
    report.reason = obstacle;
  else {
    report.multigrid = true;
    report.reason = fmt::format("{}; the direct solver's factor would take about {:.2g} GiB",
                                large ? fmt::format("{} unknowns", unknowns) : "memory", report.factor_estimate / GiB);
  }
  return report;
}

} // namespace iga::solve
