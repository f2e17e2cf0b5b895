// igasolve static: displacements, stresses and reactions, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/static_report.hpp"

namespace iga::solve {

namespace {

Results static_results(const AnalysisRun& run, const BodySystem& system, StaticSolution& solution) {
  Results results = results_head(run, "static", system);
  add_fields(run, system, solution.unknowns, {1}, Fields::All, results);
  for (std::size_t b = 0; b < results.parts.size(); ++b)
    results.parts[b].point_stress = std::move(solution.bodies[b].points.stress);
  results.statics = std::move(solution.result);
  return results;
}

std::string json_report(const AnalysisRun& run, const BodySystem& system, const StaticSolution& solution) {
  io::JsonObject report;
  add_models(report, run, system);
  report.add("statics", static_json(solution, system));
  add_end(report, run);
  return report.text();
}

std::string text_report(const AnalysisRun& run, const BodySystem& system, const StaticSolution& solution) {
  TextReport head, end;
  add_models(head, run, system);
  add_end(end, run);
  return head.text() + static_text(solution, system) + end.text();
}

} // namespace

int static_command(AnalysisRun& run) {
  const BodySystem system = make_system(run.settings, run.models);
  warn(run, space_warnings(system));
  warn_of_joined_bodies(run, system);
  StaticSolution solution;
  try {
    solution = run_static(run.settings, run.settings.statics, system);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run.settings, run.models)));
  }
  warn(run, solution.warnings);
  run.timings.insert(run.timings.end(), solution.timings.begin(), solution.timings.end());
  const std::string report =
      run.command.style == ReportStyle::Json ? json_report(run, system, solution) : text_report(run, system, solution);
  if (!run.settings.output.empty()) {
    Results results = static_results(run, system, solution);
    write_outputs(run, results);
  }
  print_report(run, report);
  return io::exit_done;
}

} // namespace iga::solve
