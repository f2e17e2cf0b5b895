#include "solver/explicit/run/explicit_report.hpp"

#include "format/io/vtp_writer.hpp"
#include "solver/explicit/run/step_bounds.hpp"
#include "solver/report/model_summary.hpp"

#include <cmath>
#include <fmt/ranges.h>
#include <optional>
#include <tbb/global_control.h>

namespace iga::solve {

namespace {

struct Peak {
  double force = 0, time = 0;
};

Peak peak_of(const TimeSeries& series, const TimeSeries::Contact& contact) {
  Peak peak;
  for (std::size_t k = 0; k < series.time.size(); ++k) {
    const double* f = &contact.force[3 * k];
    const double size = std::hypot(f[0], f[1], f[2]);
    if (size > peak.force) peak = {size, series.time[k]};
  }
  return peak;
}

double seconds_of(const Timings& timings, const char* stage) {
  for (const auto& [name, seconds] : timings)
    if (name == stage) return seconds;
  return 0;
}

std::string how_it_ended(const ExplicitOutcome& o) {
  if (const StopCondition* stop = o.loop.stopped_by())
    return fmt::format("{} {} {:g}", stop->quantity, stop->above ? "above" : "below", stop->limit);
  return o.scene.integrator().time() >= o.scene.run().time.end_time ? "end time" : "max_steps";
}

// The bounds are those at the start; what deformation and viscosity took since then shows in the last step.
void add_step(TextReport& report, const ExplicitOutcome& o) {
  const ExplicitRun& run = o.scene.run();
  const std::vector<StepBound> bounds = step_bounds(o.scene);
  std::string others;
  for (std::size_t k = 1; k < bounds.size(); ++k)
    others += fmt::format("{}{} {:.4g}", k > 1 ? ", " : "; next: ", name_of(bounds[k], run), bounds[k].dt);
  report.line("step", "at most {:.4g} by {}{}", bounds.front().dt, name_of(bounds.front(), run), others);
  report.line("", "twice the step would need {} (mass scaling is not offered)",
              fmt::join(doubling_advice(bounds, run), "; "));
}

io::JsonObject step_json(const ExplicitOutcome& o) {
  const ExplicitRun& run = o.scene.run();
  const std::vector<StepBound> bounds = step_bounds(o.scene);
  std::vector<io::JsonObject> all;
  for (const StepBound& bound : bounds) {
    all.push_back(io::JsonObject().add("by", name_of(bound, run)).add("dt", bound.dt));
    if (bound.span > 0) all.back().add("span", bound.span);
  }
  return io::JsonObject()
      .add("dt", bounds.front().dt)
      .add("by", name_of(bounds.front(), run))
      .add("bounds", all)
      .add("twice_the_step_needs", doubling_advice(bounds, run));
}

std::size_t num_threads() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

/// Share of the CPU time outside of parallel loops. Known on one thread alone: on several, threads that look for work
/// take CPU time too.
std::optional<double> serial_share(const PhaseClock& clock) {
  const PhaseClock::Times all = clock.total();
  if (!clock.measures_cpu() || num_threads() > 1 || !(all.cpu > 0)) return std::nullopt;
  return all.serial / all.cpu;
}

/// Amdahl's law.
double most_speedup(double serial, int threads) {
  return 1 / (serial + (1 - serial) / threads);
}

void add_phases(TextReport& report, const PhaseClock& clock) {
  const PhaseClock::Times all = clock.total();
  if (!(all.wall > 0)) return;
  std::string text;
  for (std::size_t p = 0; p < PhaseClock::num_phases; ++p)
    text += fmt::format("{}{} {:.1f} %", p ? ", " : "", PhaseClock::names[p], 100 * clock.times()[p].wall / all.wall);
  report.line("steps took", "{}", text);
  if (!clock.measures_cpu()) return;
  report.line("CPU time",
              "{:.3g} s of the thread that leads, {:.3g} s of it outside of parallel loops; {:.3g} s of all "
              "{} threads",
              all.cpu, all.serial, clock.cpu_of_all_threads(), num_threads());
  for (std::size_t p = 0; p < PhaseClock::num_phases; ++p)
    report.line("", "{:<18} {:8.3f} s, serial {:8.4f} s", PhaseClock::names[p], clock.times()[p].cpu,
                clock.times()[p].serial);
  if (const auto serial = serial_share(clock))
    report.line("serial",
                "{:.2f} % of the CPU time: at most {:.2f} times as fast on 2 threads, {:.1f} on 8, {:.1f} on 32",
                100 * *serial, most_speedup(*serial, 2), most_speedup(*serial, 8), most_speedup(*serial, 32));
}

io::JsonObject phases_json(const PhaseClock& clock) {
  std::vector<io::JsonObject> phases;
  for (std::size_t p = 0; p < PhaseClock::num_phases; ++p) {
    const PhaseClock::Times& times = clock.times()[p];
    phases.push_back(io::JsonObject().add("name", PhaseClock::names[p]).add("seconds", times.wall));
    if (clock.measures_cpu()) phases.back().add("cpu_seconds", times.cpu).add("serial_cpu_seconds", times.serial);
  }
  io::JsonObject all;
  all.add("threads", num_threads()).add("phases", phases);
  if (clock.measures_cpu()) all.add("cpu_seconds_of_all_threads", clock.cpu_of_all_threads());
  if (const auto serial = serial_share(clock)) all.add("serial_share", *serial);
  return all;
}

} // namespace

std::string explicit_text(const ExplicitOutcome& o) {
  TextReport report;
  const ExplicitRun& run = o.scene.run();
  const Integrator& integrator = o.scene.integrator();
  for (std::size_t b = 0; b < o.scene.num_bodies(); ++b) {
    const ExplicitBody& body = o.scene.body(b);
    const ModelSummary summary = summarise(body.space().model());
    const StartStep& limit = o.scene.limits()[b];
    report.line("body", "{}: {}, {}; {} interior, {} trimmed spans, {} points, {} unknowns, mass {:.6g} ({}){}",
                run.bodies[b].body.name, run.bodies[b].model.string(), run.bodies[b].material.name, summary.interior,
                summary.trimmed, body.space().model().points.weights.size(), body.num_unknowns(), body.mass().total(),
                name_of(run.bodies[b].body.mass),
                body.forces().sees_mean_volume() ? "; F-bar: the law sees one volume ratio per cell" : "");
    report.line("", "critical step {:.6g} by {}; {} of {} functions light: {}", limit.dt,
                limit.by_lanczos ? "Lanczos" : "the bound of single spans", body.space().num_light(),
                body.space().model().num_unknowns(), name_of(body.space().treatment().remedy));
    if (integrator.inverted(b) > 0 || integrator.eroded(b) > 0)
      report.line("", "{} times a point inverted, {} points taken out", integrator.inverted(b), integrator.eroded(b));
  }
  const double stepping = seconds_of(o.timings, "stepping");
  report.line("steps", "{} until t = {:.6g} ({}), last dt {:.4g}{}", integrator.steps(), integrator.time(),
              how_it_ended(o), integrator.dt(),
              stepping > 0
                  ? fmt::format(", {:.3g} ms per step", 1e3 * stepping / static_cast<double>(integrator.steps()))
                  : "");
  add_step(report, o);
  const auto energies = integrator.energy().values();
  std::string text;
  for (std::size_t i = 0; i < energies.size(); ++i)
    text += fmt::format("{}{} {:.5g}", i ? ", " : "", TimeSeries::energy_names[i], energies[i]);
  report.line("energy", "{}; balance off by {:.2e}", text, integrator.energy_error());
  report.line("momentum", "balance off by {:.2e} (linear), {:.2e} (angular)", o.loop.momentum_error(),
              o.loop.angular_momentum_error());
  for (const auto& contact : o.recorder.series().contacts) {
    const Peak peak = peak_of(o.recorder.series(), contact);
    report.line("contact", "{}: largest force {:.6g} at t = {:.6g}", contact.name, peak.force, peak.time);
  }
  report.line("results", "{}: {} outputs, {} fields", o.outputs.path().string(), o.recorder.num_rows(),
              o.outputs.num_fields());
  if (run.out.viewer) report.line("viewer", "{}", io::viewer_index(o.outputs.path()).string());
  double total = 0;
  std::string stages;
  for (const auto& [stage, seconds] : o.timings) {
    stages += fmt::format("{}{} {:.2f}", stages.empty() ? "" : ", ", stage, seconds);
    total += seconds;
  }
  add_phases(report, integrator.clock());
  report.line("time", "{:.2f} s ({}), peak memory {:.0f} MiB", total, stages, peak_memory_mib());
  report.lines("model says", o.scene.findings());
  report.lines("warning", o.warnings);
  return report.text();
}

std::string explicit_json(const ExplicitOutcome& o) {
  const ExplicitRun& run = o.scene.run();
  const Integrator& integrator = o.scene.integrator();
  std::vector<io::JsonObject> bodies, contacts;
  for (std::size_t b = 0; b < o.scene.num_bodies(); ++b) {
    const ExplicitBody& body = o.scene.body(b);
    const ModelSummary summary = summarise(body.space().model());
    const StartStep& limit = o.scene.limits()[b];
    io::JsonObject one, spans, light;
    spans.add("interior", summary.interior).add("trimmed", summary.trimmed);
    light.add("remedy", name_of(body.space().treatment().remedy)).add("threshold", body.space().treatment().threshold);
    light.add("functions", body.space().num_light());
    one.add("name", run.bodies[b].body.name).add("model", run.bodies[b].model.string());
    one.add("law", run.bodies[b].material.name).add("degree", body.space().model().grid.degree()).add("spans", spans);
    one.add("points", body.space().model().points.weights.size()).add("unknowns", body.num_unknowns());
    one.add("mass", body.mass().total())
        .add("mass_type", name_of(run.bodies[b].body.mass))
        .add("locking", body.forces().sees_mean_volume() ? "fbar" : "none")
        .add("light_functions", light);
    one.add("dt_crit", limit.dt).add("omega_max_bound", limit.omega).add("by_lanczos", limit.by_lanczos);
    one.add("dt_spans", limit.element_dt).add("inverted", integrator.inverted(b)).add("eroded", integrator.eroded(b));
    one.add("min_volume_ratio", integrator.report(b).min_J);
    bodies.push_back(std::move(one));
  }
  for (const auto& contact : o.recorder.series().contacts) {
    const Peak peak = peak_of(o.recorder.series(), contact);
    contacts.push_back(
        io::JsonObject().add("name", contact.name).add("peak_force", peak.force).add("peak_time", peak.time));
  }
  io::JsonObject report, energy, timings;
  const auto energies = integrator.energy().values();
  for (std::size_t i = 0; i < energies.size(); ++i) energy.add(TimeSeries::energy_names[i], energies[i]);
  for (const auto& [stage, seconds] : o.timings) timings.add(stage, seconds);
  report.add("bodies", bodies).add("steps", integrator.steps()).add("time", integrator.time());
  report.add("ended_by", how_it_ended(o)).add("dt", integrator.dt()).add("energy", energy);
  report.add("energy_error", integrator.energy_error()).add("momentum_error", o.loop.momentum_error());
  report.add("angular_momentum_error", o.loop.angular_momentum_error()).add("time_step", step_json(o));
  report.add("contacts", contacts).add("output", o.outputs.path().string()).add("outputs", o.recorder.num_rows());
  report.add("fields", o.outputs.num_fields()).add("timings", timings);
  report.add("steps_took", phases_json(integrator.clock())).add("peak_memory_mib", peak_memory_mib());
  report.add("warnings", o.warnings).add("findings", o.scene.findings());
  return report.text();
}

} // namespace iga::solve
