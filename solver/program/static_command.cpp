// igasolve static: displacements, stresses and reactions, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/output/surface_output.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/static_report.hpp"

namespace iga::solve {

namespace {

Results static_results(const AnalysisRun& run, const SolutionSpace& space, StaticSolution& solution) {
  Results results;
  results.header = results_header(run, "static", space);
  results.active_functions = run.model.functions.number;
  results.surface = sample_surface(space, run.settings.material, subdivide_surface(run.model, run.settings.subdivide),
                                   solution.unknowns, {1}, Fields::All);
  results.statics = std::move(solution.result);
  return results;
}

std::string json_report(const AnalysisRun& run, const SolutionSpace& space, const StaticSolution& solution) {
  io::JsonObject report;
  add_model(report, run, space);
  report.add("statics", static_json(solution, run.model.grid));
  add_end(report, run);
  return report.text();
}

std::string text_report(const AnalysisRun& run, const SolutionSpace& space, const StaticSolution& solution) {
  TextReport head, end;
  add_model(head, run, space);
  add_end(end, run);
  return head.text() + static_text(solution, run.model.grid) + end.text();
}

} // namespace

int static_command(AnalysisRun& run) {
  const SolutionSpace space(run.model, run.settings.light);
  warn(run, space.warnings());
  warn_of_joined_bodies(run, space);
  StaticSolution solution;
  try {
    solution = run_static(run.settings, run.settings.statics, space);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run.settings, run.model)));
  }
  warn(run, solution.warnings);
  run.timings.insert(run.timings.end(), solution.timings.begin(), solution.timings.end());
  const std::string report =
      run.command.style == ReportStyle::Json ? json_report(run, space, solution) : text_report(run, space, solution);
  if (!run.settings.output.empty()) write_outputs(run, static_results(run, space, solution));
  print_report(run, report);
  return io::exit_done;
}

} // namespace iga::solve
