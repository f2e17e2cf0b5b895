// igasolve heat: steady temperatures, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
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

// What is small against the unit is rounding.
std::string text(Point3 v, double unit) {
  for (double& c : v)
    if (std::abs(c) <= 1e-12 * unit) c = 0;
  return fmt::format("({:.6g})", fmt::join(v, ", "));
}

std::string text_report(const AnalysisRun& run, const BodySystem& system, const HeatSolution& s) {
  TextReport report;
  add_models(report, run, system);
  report.line("conductivity", "{:.6g}", *run.settings.material.conductivity);
  const Box3 box = bounding_box(run.models[0].surface.mesh);
  const double size = norm(minus(box.upper, box.lower)) + norm(box.upper);
  for (const HeatBoundaryResult& b : s.result.boundaries) {
    report.row("heat '{}' ({}): {} {:.6g}, centroid {}", b.name, b.kind, b.kind == "source" ? "volume" : "area", b.area,
               text(b.centroid, size));
    report.row("  power into the body {:.8g}, mean temperature {:.8g}", b.power, b.temperature);
  }
  report.row("balance of heat {:.2g}, relative residual {:.2g}", s.balance, s.residual);
  report.row("temperature {:.8g} at {} … {:.8g} at {}", s.least, text(s.least_at, size), s.most, text(s.most_at, size));
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    const auto three = [&](const std::vector<double>& v) { return Point3{v[3 * k], v[3 * k + 1], v[3 * k + 2]}; };
    const Point3 flux = three(p.fields.heat_flux);
    report.row("probe '{}' at {}: temperature {:.8g}, flux {}", p.names[k], text(three(p.positions), size),
               p.fields.temperature[k], text(flux, norm(flux)));
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
