// igasolve heat: steady temperatures, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/heat_analysis.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/report/analysis_report.hpp"

namespace iga::solve {

namespace {

void need_one_body(const AnalysisRun& run) {
  if (run.bodies.size() > 1)
    throw InputError(
        fmt::format("the run has {} [[bodies]]: heat is conducted in one body; run igasolve heat for each of them, "
                    "with a temperature, a flux or convection where they touch",
                    run.bodies.size()));
}

Results heat_results(const AnalysisRun& run, const BodySystem& system, HeatSolution& solution) {
  Results results = results_head(run, "heat", system);
  const SolutionSpace& space = *system[0].space;
  results.active_functions = run.models[0].functions.number;
  SurfaceResult surface;
  surface.output = subdivide_surface(run.models[0], run.settings.subdivide);
  surface.steps = {1};
  HeatSamples samples = sample_heat(space, *run.settings.material.conductivity, solution.temperature,
                                    surface.output.cell, surface.output.parameters);
  surface.fields.temperature = std::move(samples.temperature);
  surface.fields.heat_flux = std::move(samples.flux);
  results.surface = std::move(surface);
  results.heat = std::move(solution.result);
  return results;
}

std::string json_report(const AnalysisRun& run, const BodySystem& system, const HeatSolution& s) {
  io::JsonObject report;
  add_models(report, run, system);
  std::vector<io::JsonObject> boundaries, probes;
  for (const HeatBoundaryResult& b : s.result.boundaries) {
    boundaries.push_back(io::JsonObject().add("name", b.name).add("kind", b.kind).add("area", b.area));
    boundaries.back().add("centroid", b.centroid).add("temperature", b.temperature).add("power", b.power);
  }
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    const auto three = [&](const std::vector<double>& v) { return Point3{v[3 * k], v[3 * k + 1], v[3 * k + 2]}; };
    probes.push_back(io::JsonObject().add("name", p.names[k]).add("position", three(p.positions)));
    probes.back().add("temperature", p.fields.temperature[k]).add("heat_flux", three(p.fields.heat_flux));
  }
  report.add("heat", io::JsonObject()
                         .add("temperature_unknowns", s.temperature.size())
                         .add("boundaries", boundaries)
                         .add("probes", probes)
                         .add("balance", s.balance)
                         .add("least", s.least)
                         .add("least_at", s.least_at)
                         .add("most", s.most)
                         .add("most_at", s.most_at)
                         .add("residual", s.residual));
  add_end(report, run);
  return report.text();
}

std::string text_report(const AnalysisRun& run, const BodySystem& system, const HeatSolution& s) {
  TextReport report;
  add_models(report, run, system);
  report.line("conductivity", "{:.6g}", *run.settings.material.conductivity);
  for (const HeatBoundaryResult& b : s.result.boundaries) {
    report.row("heat '{}' ({}): {} {:.6g}, centroid ({:.6g})", b.name, b.kind, b.kind == "source" ? "volume" : "area",
               b.area, fmt::join(b.centroid, ", "));
    report.row("  power into the body {:.8g}, mean temperature {:.8g}", b.power, b.temperature);
  }
  report.row("balance of heat {:.2g}, relative residual {:.2g}", s.balance, s.residual);
  report.row("temperature {:.8g} at ({:.6g}) … {:.8g} at ({:.6g})", s.least, fmt::join(s.least_at, ", "), s.most,
             fmt::join(s.most_at, ", "));
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    const auto three = [&](const std::vector<double>& v) { return std::span(v).subspan(3 * k, 3); };
    report.row("probe '{}' at ({:.6g}): temperature {:.8g}, flux ({:.6g})", p.names[k],
               fmt::join(three(p.positions), ", "), p.fields.temperature[k],
               fmt::join(three(p.fields.heat_flux), ", "));
  }
  add_end(report, run);
  return report.text();
}

} // namespace

int heat_command(AnalysisRun& run) {
  need_one_body(run);
  const BodySystem system = make_system(run.settings, run.models);
  warn(run, space_warnings(system));
  warn_of_joined_bodies(run, system);
  // One of [[bodies]] is a body like any other.
  run.settings.material = system[0].material;
  HeatSolution solution;
  try {
    solution = run_heat(run.settings, *system[0].space);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run.settings, run.models)));
  }
  warn(run, solution.warnings);
  run.timings.insert(run.timings.end(), solution.timings.begin(), solution.timings.end());
  const std::string report =
      run.command.style == ReportStyle::Json ? json_report(run, system, solution) : text_report(run, system, solution);
  if (!run.settings.output.empty()) {
    Results results = heat_results(run, system, solution);
    write_outputs(run, results);
  }
  print_report(run, report);
  return io::exit_done;
}

} // namespace iga::solve
