#include "solver/report/analysis_report.hpp"

#include "format/io/field_files.hpp"
#include "format/io/progress.hpp"
#include "format/io/results_io.hpp"
#include "format/io/sha256.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/version.hpp"
#include "solver/base/interruptible.hpp"
#include "solver/report/model_notes.hpp"
#include "solver/report/model_summary.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <sstream>
#include <sys/resource.h>

namespace iga::solve {

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void warn(AnalysisRun& run, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    if (std::find(run.warnings.begin(), run.warnings.end(), warning) != run.warnings.end()) continue;
    if (run.command.style != ReportStyle::Quiet) io::write_message(fmt::format("igasolve: warning: {}\n", warning));
    run.warnings.push_back(warning);
  }
}

void warn_of_joined_bodies(AnalysisRun& run, const BodySystem& system) {
  for (std::size_t b = 0; b < system.size(); ++b)
    if (const auto warning = joined_bodies_warning(*system[b].space)) warn(run, {system.prefix(b) + *warning});
}

std::vector<std::string> TextReport::lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

namespace {

void add_model(TextReport& report, const RunBody& body, const TrimmedModel& m, const SolutionSpace& space) {
  const ModelSummary summary = summarise(m);
  report.line("model", "{}{}", body.file.model.string(), m.title.empty() ? "" : fmt::format(" ({})", m.title));
  report.line("spans", "{} interior, {} trimmed; degree {}, {} points", summary.interior, summary.trimmed,
              fmt::join(m.grid.degree(), " "), m.points.weights.size());
  report.line("material", "{}", material_text(body.words, summary.volume));
  report.line("unknowns", "{}{}", space.num_unknowns(),
              space.num_light() == 0
                  ? ""
                  : fmt::format("; {} of {} functions are light (mass fraction below {:g}): {}", space.num_light(),
                                m.num_unknowns(), space.treatment().threshold, name_of(space.treatment().remedy)));
}

void add_model(io::JsonObject& report, const RunBody& body, const TrimmedModel& m, const SolutionSpace& space) {
  const ModelSummary summary = summarise(m);
  io::JsonObject spans, light;
  spans.add("interior", summary.interior).add("trimmed", summary.trimmed);
  light.add("remedy", name_of(space.treatment().remedy)).add("threshold", space.treatment().threshold);
  light.add("functions", space.num_light());
  report.add("model", body.file.model.string()).add("title", m.title).add("length_unit", m.length_unit);
  report.add("degree", m.grid.degree()).add("spans", spans).add("points", m.points.weights.size());
  report.add("unknowns", space.num_unknowns()).add("light_functions", light);
  const MaterialWords& words = body.words;
  io::JsonObject material;
  material.add("name", words.name).add("source", words.source).add("unit_system", words.units ? words.units->name : "");
  if (words.E) material.add("E", *words.E).add("nu", *words.nu);
  if (words.rho) material.add("rho", *words.rho);
  if (words.expansion) material.add("expansion", *words.expansion);
  if (words.conductivity) material.add("conductivity", *words.conductivity);
  if (const auto mass = mass_in_kg(words, summary.volume)) material.add("mass_in_kg", *mass);
  report.add("material", material);
}

} // namespace

void add_models(TextReport& report, const AnalysisRun& run, const BodySystem& system) {
  for (std::size_t b = 0; b < system.size(); ++b) {
    if (system.size() > 1) report.line("body", "'{}'", system[b].name);
    add_model(report, run.bodies[b], run.models[b], *system[b].space);
  }
  if (system.size() > 1) report.line("system", "{} bodies, {} unknowns", system.size(), system.num_unknowns());
}

void add_models(io::JsonObject& report, const AnalysisRun& run, const BodySystem& system) {
  if (system.size() == 1) return add_model(report, run.bodies[0], run.models[0], *system[0].space);
  std::vector<io::JsonObject> bodies(system.size());
  for (std::size_t b = 0; b < system.size(); ++b) {
    bodies[b].add("name", system[b].name);
    add_model(bodies[b], run.bodies[b], run.models[b], *system[b].space);
  }
  report.add("models", bodies).add("unknowns", system.num_unknowns());
}

void add_ties(TextReport& report, const std::vector<TieReport>& ties) {
  for (const TieReport& t : ties)
    report.line("tie",
                "{}: '{}' and '{}': area {:.8g} of {:.6g} and {:.6g} chosen, largest gap {:.3g} (tolerance {:.3g})",
                t.name, t.bodies[0], t.bodies[1], t.area, t.chosen[0], t.chosen[1], t.largest_gap, t.tolerance);
}

io::JsonObject json_of(const SolverReport& solver) {
  return io::JsonObject()
      .add("kind", solver.multigrid ? "multigrid" : "direct")
      .add("reason", solver.reason)
      .add("factor_bytes_estimate", solver.factor_estimate)
      .add("level_nodes", solver.level_nodes)
      .add("steps", solver.steps);
}

std::vector<io::JsonObject> json_of(const std::vector<TieReport>& ties) {
  std::vector<io::JsonObject> list;
  for (const TieReport& t : ties) {
    list.push_back(io::JsonObject().add("name", t.name).add("bodies", t.bodies).add("area", t.area));
    list.back().add("chosen_areas", t.chosen).add("largest_gap", t.largest_gap).add("tolerance", t.tolerance);
    list.back().add("points", t.points);
  }
  return list;
}

std::string of_body(const BodySystem& system, std::size_t body) {
  return system.size() == 1 ? "" : fmt::format(" of body '{}'", system[body].name);
}

namespace {

std::string extent_text(const RegionReport& r) {
  return r.extent == Extent::Surface ? fmt::format("area {:.8g}", r.area)
         : r.extent == Extent::Line  ? fmt::format("length {:.8g}", r.length)
                                     : "a point";
}

std::string place_text(const RegionReport& r) {
  return fmt::format("{}{}: {}, centroid ({:.6g})", r.name, r.body.empty() ? "" : fmt::format(" on '{}'", r.body),
                     extent_text(r), fmt::join(r.centroid, ", "));
}

io::JsonObject place_json(const RegionReport& r) {
  io::JsonObject object;
  object.add("name", r.name).add("area", r.area).add("length", r.length).add("centroid", r.centroid);
  if (!r.body.empty()) object.add("body", r.body);
  return object;
}

} // namespace

std::string text_of(const AttachedParts::OfSpring& spring) {
  const Spring& s = spring.spring;
  if (s.to)
    return fmt::format("{}, to another end at ({:.6g}); stiffness {}", place_text(spring.region),
                       fmt::join(spring.other, ", "),
                       s.total ? fmt::format("{:.6g} along its axes, halfway", fmt::join(*s.total, ", "))
                               : fmt::format("{:.6g} along the line between both", s.axial));
  return place_text(spring.region) +
         (s.total ? fmt::format("; stiffness {:.6g} along its axes", fmt::join(*s.total, ", "))
                  : fmt::format("; stiffness of a unit area {:.6g} along the normal, {:.6g} across", s.normal,
                                s.tangential));
}

std::string text_of(const AttachedParts::OfMass& mass) {
  std::string text = fmt::format("{}; mass {:.8g}", place_text(mass.region), mass.added.mass);
  if (!mass.added.rigid) return text + (mass.region.extent == Extent::Point ? "" : " spread evenly");
  const Eigen::Matrix3d& J = mass.added.inertia;
  return text +
         fmt::format(", a rigid body about ({:.6g}), inertia xx yy zz xy yz zx {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} "
                     "{:.6g}, {}",
                     fmt::join(mass.centre, ", "), J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(1, 2), J(2, 0),
                     mass.added.holds_region ? "holds the region rigid" : "moves with the region's average motion");
}

void add_attached(TextReport& report, const AttachedParts& attached) {
  for (const auto& spring : attached.springs) report.line("spring", "{}", text_of(spring));
  double sum = 0;
  for (const auto& mass : attached.masses) {
    report.line("added mass", "{}", text_of(mass));
    sum += mass.added.mass;
  }
  if (!attached.masses.empty()) report.line("added", "{:.8g} in all", sum);
}

void add_attached(io::JsonObject& report, const AttachedParts& attached) {
  std::vector<io::JsonObject> springs, masses;
  double sum = 0;
  for (const auto& [region, spring, other] : attached.springs) {
    springs.push_back(place_json(region));
    if (spring.to) springs.back().add("other_centroid", other);
    if (spring.to && !spring.total) springs.back().add("axial", spring.axial);
    if (spring.to && !spring.total) continue;
    if (spring.total)
      springs.back().add("stiffness", *spring.total);
    else
      springs.back().add("normal_stiffness", spring.normal).add("tangential_stiffness", spring.tangential);
  }
  for (const auto& [region, added, centre] : attached.masses) {
    masses.push_back(place_json(region));
    masses.back().add("mass", added.mass).add("rigid", added.rigid).add("centre", centre);
    if (added.rigid) masses.back().add("holds_region", added.holds_region);
    sum += added.mass;
  }
  if (!springs.empty()) report.add("springs", springs);
  if (!masses.empty()) report.add("added_masses", masses).add("added_mass", sum);
}

void add_regions(TextReport& report, const std::vector<RegionReport>& regions) {
  for (const RegionReport& r : regions)
    report.line("support", "{}{}: {}, centroid ({:.6g}), {} points{}{}", r.name,
                r.body.empty() ? "" : fmt::format(" on '{}'", r.body), extent_text(r), fmt::join(r.centroid, ", "),
                r.points, r.note.empty() ? "" : "\n", r.note);
}

std::vector<io::JsonObject> json_of(const std::vector<RegionReport>& regions) {
  std::vector<io::JsonObject> list;
  for (const RegionReport& r : regions) {
    list.push_back(io::JsonObject().add("name", r.name).add("area", r.area).add("length", r.length));
    list.back().add("centroid", r.centroid).add("points", r.points).add("note", r.note);
    if (!r.body.empty()) list.back().add("body", r.body);
  }
  return list;
}

namespace {

std::vector<std::string> findings_of(const AnalysisRun& run) {
  if (run.models.size() == 1) return run.models[0].provenance.findings;
  std::vector<std::string> all;
  for (std::size_t b = 0; b < run.models.size(); ++b)
    for (const std::string& finding : run.models[b].provenance.findings)
      all.push_back(fmt::format("body '{}': {}", run.bodies[b].file.name, finding));
  return all;
}

} // namespace

void add_end(TextReport& report, const AnalysisRun& run) {
  if (!run.settings.output.empty()) report.line("results", "{}", run.settings.output.string());
  if (!run.settings.output.empty() && run.settings.viewer && run.settings.analysis != Analysis::Timestep)
    report.line("viewer", "{}", io::viewer_index(run.settings.output).string());
  std::string stages;
  double total = 0;
  for (const auto& [stage, seconds] : run.timings) {
    stages += fmt::format("{}{} {:.2f}", stages.empty() ? "" : ", ", stage, seconds);
    total += seconds;
  }
  report.line("time", "{:.2f} s ({}), peak memory {:.0f} MiB", total, stages, peak_memory_mib());
  report.lines("model says", findings_of(run));
  report.lines("warning", run.warnings);
}

void add_end(io::JsonObject& report, const AnalysisRun& run) {
  if (!run.settings.output.empty()) report.add("output", run.settings.output.string());
  io::JsonObject timings;
  for (const auto& [stage, seconds] : run.timings) timings.add(stage, seconds);
  report.add("timings", timings).add("peak_memory_mib", peak_memory_mib()).add("warnings", run.warnings);
  report.add("findings", findings_of(run));
}

namespace {

BodyResult body_head(const AnalysisRun& run, const SystemBody& body, const RunBody& of_run) {
  BodyResult head;
  head.name = body.name;
  head.model_file = of_run.file.model.filename().string();
  head.model_sha256 = io::sha256_file(of_run.file.model);
  head.law = "linear-elastic";
  head.mass = name_of(run.settings.mass);
  head.light_functions = name_of(body.space->treatment().remedy);
  head.light_threshold = body.space->treatment().threshold;
  head.unknowns = body.space->num_unknowns();
  head.density = body.material.density;
  return head;
}

} // namespace

Results results_head(const AnalysisRun& run, const char* analysis, const BodySystem& system) {
  Results results;
  for (std::size_t b = 0; b < system.size(); ++b) results.bodies.push_back(body_head(run, system[b], run.bodies[b]));
  // The head of all analyses speaks of one model: the first body's.
  const BodyResult& first = results.bodies.front();
  ResultsHeader& head = results.header;
  head.analysis = analysis;
  head.title = run.models[0].title;
  head.length_unit = run.models[0].length_unit;
  head.model_file = first.model_file;
  head.model_sha256 = first.model_sha256;
  head.light_functions = first.light_functions;
  head.light_threshold = first.light_threshold;
  head.unknowns = system.num_unknowns();
  head.density = first.density;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) head.stiffness[static_cast<std::size_t>(6 * i + j)] = system[0].material.C(i, j);
  Provenance& p = head.provenance;
  p.producer = "igasolve";
  p.version = program_version();
  p.command_line = run.command.text;
  for (const BodyResult& body : results.bodies) p.inputs.push_back({body.model_file, body.model_sha256});
  if (!run.command.run_file.empty())
    p.inputs.push_back({run.command.run_file.filename().string(), io::sha256_file(run.command.run_file)});
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                          fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  p.timings = run.timings;
  p.findings = findings_of(run);
  p.warnings = run.warnings;
  if (system.size() == 1) {
    results.bodies.clear();
  } else {
    head.title.clear();
    for (const SystemBody& body : system) head.title += (head.title.empty() ? "" : ", ") + body.name;
  }
  return results;
}

void add_fields(const AnalysisRun& run, const BodySystem& system, const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                const std::vector<double>& steps, Fields fields, Results& results) {
  const bool alone = system.size() == 1;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SystemBody& body = system[b];
    const auto own = unknowns.middleRows(body.first_unknown(), body.space->num_unknowns());
    SurfaceResult surface =
        sample_surface(*body.space, body.material, subdivide_surface(run.models[b], run.settings.subdivide), own, steps,
                       alone ? fields : Fields::All); // field files hold a strain
    if (alone) {
      results.active_functions = run.models[b].functions.number;
      results.surface = std::move(surface);
      return;
    }
    BodyPart part{body.name, run.models[b].functions.number, {}, std::move(surface), {}};
    for (Eigen::Index step = 0; step < own.cols(); ++step) {
      const Eigen::VectorXd all = body.space->expand(own.col(step));
      part.coefficients.insert(part.coefficients.end(), all.data(), all.data() + all.size());
    }
    results.parts.push_back(std::move(part));
  }
}

void write_outputs(const AnalysisRun& run, Results& results) {
  const OutputsBeingWritten writing;
  if (!results.parts.empty()) io::write_parts(run.settings.output, results);
  io::write_results(run.settings.output, results, run.command.force);
  if (run.settings.viewer) io::write_viewer_files(run.settings.output, results, run.command.force);
}

void print_report(const AnalysisRun& run, const std::string& report) {
  if (run.settings.progress) run.settings.progress->finish();
  if (run.command.style == ReportStyle::Quiet) return;
  io::write_report(fmt::format("{}{}", report, run.command.style == ReportStyle::Json ? "\n" : ""));
}

} // namespace iga::solve
