// igasolve transient: answers to loads and base accelerations over time, as report and results file.
#include "format/io/run_tool.hpp"
#include "solver/report/response_report.hpp"

namespace iga::solve {

namespace {

Results transient_results(const AnalysisRun& run, const ResponseSystem& system, const TransientResponse& response) {
  Results results = results_head(run, "transient", system.system);
  results.tables = tables_of(system, response);
  add_fields(run, system.system, system.basis.vectors * response.field_modal, response.fields, Fields::All, results);
  return results;
}

std::string text_report(const AnalysisRun& run, const ResponseSystem& system, const TransientResponse& response) {
  TextReport report;
  add_response(report, run, system);
  report.line("range", "0 … {:.6g}, {} outputs; exact for straight lines between the times of a history",
              response.times.back(), response.times.size());
  add_peaks(report, system, peaks_of(system, response), "at time");
  if (!run.settings.output.empty()) report.line("fields", "at {:.6g}", fmt::join(response.fields, ", "));
  add_end(report, run);
  return report.text();
}

std::string json_report(const AnalysisRun& run, const ResponseSystem& system, const TransientResponse& response) {
  io::JsonObject report;
  add_response(report, run, system);
  report.add("outputs", response.times.size()).add("fields", response.fields);
  report.add("probes", json_of(system, peaks_of(system, response), "time"));
  add_end(report, run);
  return report.text();
}

} // namespace

int transient_command(AnalysisRun& run) {
  const ResponseSystem system = prepare_response(run.settings, run.models, 0);
  warn(run, system.warnings);
  warn_of_joined_bodies(run, system.system);
  warn_of_range(run, system, 0);
  const TransientResponse response = transient_response(system, run.settings.response);
  run.timings.insert(run.timings.end(), system.timings.begin(), system.timings.end());
  if (!run.settings.output.empty()) {
    Results results = transient_results(run, system, response);
    write_outputs(run, results);
  }
  print_report(run, run.command.style == ReportStyle::Json ? json_report(run, system, response)
                                                           : text_report(run, system, response));
  return io::exit_done;
}

} // namespace iga::solve
