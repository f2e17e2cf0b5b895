// igasolve random: root mean squares of the answer to random vibration, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/report/response_report.hpp"
#include "solver/response/rms_fields.hpp"

namespace iga::solve {

namespace {

Results random_results(const AnalysisRun& run, const ResponseSystem& system, const RandomResponse& response) {
  Results results = results_head(run, "random", system.system);
  results.tables = tables_of(system, response);
  show_stage(run.settings.progress, "fields");
  const SystemBody& body = system.system[0];
  SurfaceResult surface;
  surface.output = subdivide_surface(run.models[0], run.settings.subdivide);
  surface.steps = {1};
  surface.fields = rms_fields(*body.space, body.material, {surface.output.cell, surface.output.parameters},
                              system.basis.vectors * independent_parts(response.covariance, system.basis));
  results.active_functions = run.models[0].functions.number;
  results.surface = std::move(surface);
  return results;
}

std::string text_report(const AnalysisRun& run, const ResponseSystem& system, const RandomResponse& response) {
  TextReport report;
  add_response(report, run, system);
  report.line("range", "{:.6g} … {:.6g}", response.from, response.to);
  if (!response.base.empty()) report.line("base", "acceleration {:.6g} (1 sigma)", std::sqrt(response.base[0]));
  add_rms(report, system, rms_of(system, response));
  add_end(report, run);
  return report.text();
}

std::string json_report(const AnalysisRun& run, const ResponseSystem& system, const RandomResponse& response) {
  io::JsonObject report;
  add_response(report, run, system);
  report.add("from", response.from).add("to", response.to);
  if (!response.base.empty()) report.add("base_acceleration", std::sqrt(response.base[0]));
  report.add("probes", json_of(system, rms_of(system, response)));
  add_end(report, run);
  return report.text();
}

} // namespace

int random_command(AnalysisRun& run) {
  if (run.models.size() > 1 && !run.settings.output.empty())
    throw InputError("root mean squares over the surface are made for one body alone, but the run has several; leave "
                     "the output out (the report has the probes of all), or make one model of them");
  const double highest = random_range(run.settings.response).second;
  const ResponseSystem system = prepare_response(run.settings, run.models, highest);
  warn(run, system.warnings);
  warn_of_joined_bodies(run, system.system);
  warn_of_range(run, system, highest);
  const RandomResponse response = random_response(system, run.settings.response);
  run.timings.insert(run.timings.end(), system.timings.begin(), system.timings.end());
  if (!run.settings.output.empty()) {
    Results results = random_results(run, system, response);
    write_outputs(run, results);
  }
  print_report(run, run.command.style == ReportStyle::Json ? json_report(run, system, response)
                                                           : text_report(run, system, response));
  return io::exit_done;
}

} // namespace iga::solve
