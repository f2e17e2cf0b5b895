// igasolve harmonic: frequency response to loads and base motion, as report and results file.
#include "format/io/run_tool.hpp"
#include "solver/report/response_report.hpp"
#include "solver/response/stress_forms.hpp"

namespace iga::solve {

namespace {

// In the place of the von Mises stress of an instant: the largest over a cycle, at both steps of each frequency.
void take_largest_von_mises(SurfaceResult& surface) {
  FieldSamples& f = surface.fields;
  const std::size_t n = surface.output.mesh.vertices.size();
  for (std::size_t pair = 0; pair + 1 < surface.steps.size(); pair += 2)
    for (std::size_t v = 0; v < n; ++v) {
      const std::size_t now = pair * n + v, later = now + n;
      const double largest = von_mises_over_cycle(Voigt(&f.stress[6 * now]), Voigt(&f.stress[6 * later]));
      f.von_mises[now] = f.von_mises[later] = largest;
    }
}

Results harmonic_results(const AnalysisRun& run, const ResponseSystem& system, const HarmonicResponse& response) {
  Results results = results_head(run, "harmonic", system.system);
  results.tables = tables_of(system, response);
  Eigen::MatrixXd unknowns(system.unknowns, 2 * response.field_modal.cols());
  std::vector<double> steps;
  for (Eigen::Index k = 0; k < response.field_modal.cols(); ++k) {
    // Re(U e^(iφ)) = Re U cos φ - Im U sin φ.
    unknowns.col(2 * k) = system.basis.vectors * response.field_modal.col(k).real();
    unknowns.col(2 * k + 1) = -(system.basis.vectors * response.field_modal.col(k).imag());
  }
  for (Eigen::Index k = 0; k < unknowns.cols(); ++k) steps.push_back(static_cast<double>(k + 1));
  add_fields(run, system.system, unknowns, steps, Fields::All, results);
  if (results.surface) take_largest_von_mises(*results.surface);
  for (BodyPart& part : results.parts) take_largest_von_mises(part.surface);
  return results;
}

std::string text_report(const AnalysisRun& run, const ResponseSystem& system, const HarmonicResponse& response) {
  TextReport report;
  add_response(report, run, system);
  report.line("range", "{:.6g} … {:.6g}, {} frequencies, at each resonance those where its phase turns by 10°",
              response.frequencies.front(), response.frequencies.back(), response.frequencies.size());
  add_peaks(report, system, peaks_of(system, response), "at frequency");
  if (!run.settings.output.empty()) report.line("fields", "at {:.6g}", fmt::join(response.fields, ", "));
  add_end(report, run);
  return report.text();
}

std::string json_report(const AnalysisRun& run, const ResponseSystem& system, const HarmonicResponse& response) {
  io::JsonObject report;
  add_response(report, run, system);
  report.add("response_frequencies", response.frequencies.size()).add("fields", response.fields);
  report.add("probes", json_of(system, peaks_of(system, response), "frequency"));
  add_end(report, run);
  return report.text();
}

} // namespace

int harmonic_command(AnalysisRun& run) {
  const double highest = harmonic_range(run.settings.response).second;
  const ResponseSystem system = prepare_response(run.settings, run.models, highest);
  warn(run, system.warnings);
  warn_of_joined_bodies(run, system.system);
  warn_of_range(run, system, highest);
  const HarmonicResponse response = harmonic_response(system, run.settings.response);
  warn(run, undamped_resonances(system, response));
  run.timings.insert(run.timings.end(), system.timings.begin(), system.timings.end());
  if (!run.settings.output.empty()) {
    Results results = harmonic_results(run, system, response);
    write_outputs(run, results);
  }
  print_report(run, run.command.style == ReportStyle::Json ? json_report(run, system, response)
                                                           : text_report(run, system, response));
  return io::exit_done;
}

} // namespace iga::solve
