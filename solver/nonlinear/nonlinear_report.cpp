#include "solver/nonlinear/nonlinear_report.hpp"

#include "format/io/vtp_writer.hpp"
#include "format/model/vec3.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/report/model_summary.hpp"

namespace iga::solve {

namespace {

std::string vector_text(const Point3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

std::vector<Point3> last_probes(const NonlinearOutcome& o) {
  return o.statics.probe_displacements();
}

} // namespace

std::vector<std::string> step_warnings(const NonlinearRun& run, double span_size,
                                       const std::vector<StepReport>& steps) {
  std::vector<std::string> all;
  for (const StepReport& step : steps)
    if (step.points.inverted > 0) {
      all.push_back(fmt::format("from the load factor {:.5g} on points lie below min_volume_ratio = {:g} ({} there): "
                                "what resists full crushing is no law of the material; smaller spans or a smaller load",
                                step.factor, run.material.inversion.smallest_J, step.points.inverted));
      break;
    }
  for (const StepReport& step : steps)
    if (!step.definite) {
      all.push_back(fmt::format("at the load factor {:.5g} the stiffness is not positive definite: the part has passed "
                                "a point where it buckles or gives way, and what was found beyond may be unstable",
                                step.factor));
      break;
    }
  for (std::size_t c = 0; c < run.contacts.size(); ++c) {
    const StepReport* deepest = nullptr;
    for (const StepReport& step : steps)
      if (!deepest || step.contacts[c].depth > deepest->contacts[c].depth) deepest = &step;
    if (!deepest) continue;
    const ToolContactReport& r = deepest->contacts[c];
    const double share = run.contacts[c].stiffness * r.depth / span_size; // of E
    constexpr double most_of_metal = 0.05; // several times the yield stress of the hardest
    if (std::holds_alternative<J2Plasticity>(run.material.law) && share > most_of_metal)
      all.push_back(
          fmt::format("contact '{}': the largest pressure, at ({:.4g}, {:.4g}, {:.4g}), is {:.2g} E, more than "
                      "metal bears: pressure oscillates where metal flows without change of volume and "
                      "sticks to a tool, and forces are not to be relied upon; less friction, smaller spans",
                      run.contacts[c].name, r.deepest[0], r.deepest[1], r.deepest[2], share,
                      run.locking == Locking::None ? ", or locking = \"fbar\"" : ""));
    if (r.depth <= run.depth_warning * span_size) continue;
    all.push_back(fmt::format("contact '{}': the part sinks {:.2g} spans into the tool at the load factor {:.5g}, at "
                              "({:.4g}, {:.4g}, {:.4g}); a larger stiffness than {:g} or smaller spans",
                              run.contacts[c].name, r.depth / span_size, deepest->factor, r.deepest[0], r.deepest[1],
                              r.deepest[2], run.contacts[c].stiffness));
  }
  return all;
}

std::string nonlinear_text(const NonlinearOutcome& o) {
  TextReport report;
  const SolutionSpace& space = o.statics.body().space();
  const ModelSummary summary = summarise(space.model());
  report.line("model", "{}: {}; {} interior, {} trimmed spans, {} points, {} unknowns", o.run.model.string(),
              o.run.material.name, summary.interior, summary.trimmed, space.model().points.weights.size(),
              space.num_unknowns());
  report.line("", "{} of {} functions light: {}", space.num_light(), space.model().num_unknowns(),
              name_of(space.treatment().remedy));
  if (o.run.locking == Locking::FBar)
    report.line("",
                "F-bar: the law sees one volume ratio per cell, the mean (locking = \"none\": those of the points)");
  report.row("");
  report.row("  {:>12}  {:>10}  {:>5}  {:>9}  {:>14}", "load factor", "iterations", "cuts", "residual",
             "smallest det F");
  for (const StepReport& step : o.steps)
    report.row("  {:>12.6g}  {:>10}  {:>5}  {:>9.1e}  {:>14.4f}{}", step.factor, step.iterations, step.cuts,
               step.residual, step.points.min_J, step.definite ? "" : "  not positive definite");
  report.row("");
  for (const LoadReport& load : o.statics.loads()) {
    const bool on_region = load.region.points > 0;
    report.line("load", "{}: {}force {} at λ = 1, undeformed", load.name,
                on_region && load.region.area > 0 ? fmt::format("area {:.6g}, ", load.region.area) : "",
                vector_text(load.force));
  }
  report.line("loads", "sum {} at the load factor {:.6g}", vector_text(o.statics.load_force()), o.statics.factor());
  Point3 balance = o.statics.load_force();
  for (const SupportForce& support : o.statics.support_forces()) {
    report.line("support", "{}: reaction {}{}", support.name, vector_text(support.force),
                support.gap > 0 ? fmt::format(", gives way by {:.3g} (root mean square)", support.gap) : "");
    balance = plus(balance, support.force);
  }
  for (std::size_t c = 0; c < o.run.contacts.size(); ++c) {
    const ToolContactReport& r = o.statics.contact_reports()[c];
    report.line("contact", "{}: force {} on the part, normal {:.6g}, friction {:.6g}", o.run.contacts[c].name,
                vector_text(r.force), r.normal_force, r.friction_force);
    report.line("", "area {:.6g} (undeformed), {} points of which {} slide, {:.2g} spans deep", r.area, r.points,
                r.sliding, r.depth / o.statics.contacts()[c].span_size());
    balance = plus(balance, r.force);
  }
  report.line("balance", "{} {}", o.run.contacts.empty() ? "loads + reactions" : "loads + reactions + contacts",
              vector_text(balance));
  const std::vector<Point3> probes = last_probes(o);
  for (std::size_t k = 0; k < probes.size(); ++k)
    report.line("probe", "{}: displacement {}", o.run.probes[k].name, vector_text(probes[k]));
  report.line("energy", "internal forces did the work {:.6g}", o.statics.internal_work());
  if (!o.run.contacts.empty())
    report.line("", "loads, supports and tools {:.6g}; contact stores {:.6g}, friction took {:.6g}; {:.2g} is missing",
                o.statics.external_work(), o.statics.contact_energy(), o.statics.friction_energy(),
                o.statics.external_work() - o.statics.internal_work() - o.statics.contact_energy() -
                    o.statics.friction_energy());
  if (!o.outputs.path().empty()) {
    report.line("results", "{}: {} steps", o.outputs.path().string(), o.outputs.series().time.size());
    if (o.run.viewer) report.line("viewer", "{}", io::viewer_index(o.outputs.path()).string());
  }
  double total = 0;
  std::string stages;
  for (const auto& [stage, seconds] : o.timings) {
    stages += fmt::format("{}{} {:.2f}", stages.empty() ? "" : ", ", stage, seconds);
    total += seconds;
  }
  report.line("time", "{:.2f} s ({}), peak memory {:.0f} MiB", total, stages, peak_memory_mib());
  report.lines("found", o.findings);
  report.lines("warning", o.warnings);
  return report.text();
}

std::string nonlinear_json(const NonlinearOutcome& o) {
  const SolutionSpace& space = o.statics.body().space();
  const ModelSummary summary = summarise(space.model());
  std::vector<io::JsonObject> steps, supports, probes, contacts;
  for (const StepReport& step : o.steps) {
    steps.push_back(io::JsonObject()
                        .add("factor", step.factor)
                        .add("iterations", step.iterations)
                        .add("cuts", step.cuts)
                        .add("residual", step.residual)
                        .add("min_volume_ratio", step.points.min_J)
                        .add("inverted", step.points.inverted));
    if (step.symmetric) steps.back().add("positive_definite", step.definite);
  }
  for (const SupportForce& support : o.statics.support_forces())
    supports.push_back(io::JsonObject()
                           .add("name", support.name)
                           .add("force", support.force)
                           .add("moment", support.moment)
                           .add("gap", support.gap));
  for (std::size_t c = 0; c < o.run.contacts.size(); ++c) {
    const ToolContactReport& r = o.statics.contact_reports()[c];
    contacts.push_back(io::JsonObject()
                           .add("name", o.run.contacts[c].name)
                           .add("force", r.force)
                           .add("moment", r.moment)
                           .add("normal_force", r.normal_force)
                           .add("friction_force", r.friction_force)
                           .add("area", r.area)
                           .add("points", r.points)
                           .add("sliding", r.sliding)
                           .add("depth", r.depth)
                           .add("depth_in_spans", r.depth / o.statics.contacts()[c].span_size()));
  }
  const std::vector<Point3> displacements = last_probes(o);
  for (std::size_t k = 0; k < displacements.size(); ++k)
    probes.push_back(io::JsonObject()
                         .add("name", o.run.probes[k].name)
                         .add("position", o.run.probes[k].position)
                         .add("displacement", displacements[k]));
  io::JsonObject report, spans, timings;
  spans.add("interior", summary.interior).add("trimmed", summary.trimmed);
  for (const auto& [stage, seconds] : o.timings) timings.add(stage, seconds);
  report.add("model", o.run.model.string()).add("law", o.run.material.name);
  report.add("locking", o.run.locking == Locking::FBar ? "fbar" : "none").add("degree", space.model().grid.degree());
  report.add("spans", spans).add("points", space.model().points.weights.size()).add("unknowns", space.num_unknowns());
  report.add("factor", o.statics.factor()).add("steps", steps).add("load_force", o.statics.load_force());
  report.add("supports", supports).add("probes", probes).add("internal_work", o.statics.internal_work());
  if (!contacts.empty())
    report.add("contacts", contacts)
        .add("external_work", o.statics.external_work())
        .add("contact_energy", o.statics.contact_energy())
        .add("friction_energy", o.statics.friction_energy());
  report.add("output", o.outputs.path().string()).add("timings", timings).add("peak_memory_mib", peak_memory_mib());
  report.add("warnings", o.warnings).add("findings", o.findings);
  return report.text();
}

} // namespace iga::solve
