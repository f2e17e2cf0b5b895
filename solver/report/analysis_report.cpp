#include "solver/report/analysis_report.hpp"

#include "format/io/progress.hpp"
#include "format/io/results_io.hpp"
#include "format/io/sha256.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/version.hpp"
#include "solver/base/interruptible.hpp"
#include "solver/report/model_notes.hpp"
#include "solver/report/model_summary.hpp"

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
  if (run.command.style != ReportStyle::Quiet)
    for (const std::string& warning : warnings) io::write_message(fmt::format("igasolve: warning: {}\n", warning));
  run.warnings.insert(run.warnings.end(), warnings.begin(), warnings.end());
}

void warn_of_joined_bodies(AnalysisRun& run, const SolutionSpace& space) {
  if (const auto warning = joined_bodies_warning(space)) warn(run, {*warning});
}

std::vector<std::string> TextReport::lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void add_model(TextReport& report, const AnalysisRun& run, const SolutionSpace& space) {
  const TrimmedModel& m = run.model;
  const ModelSummary summary = summarise(m);
  report.line("model", "{}{}", run.settings.model.string(), m.title.empty() ? "" : fmt::format(" ({})", m.title));
  report.line("spans", "{} interior, {} trimmed; degree {}, {} points", summary.interior, summary.trimmed,
              fmt::join(m.grid.degree(), " "), m.points.weights.size());
  report.line("material", "{}", material_text(run.settings.words, summary.volume));
  report.line("unknowns", "{}{}", space.num_unknowns(),
              space.num_light() == 0
                  ? ""
                  : fmt::format("; {} of {} functions are light (mass fraction below {:g}): {}", space.num_light(),
                                m.num_unknowns(), space.treatment().threshold, name_of(space.treatment().remedy)));
}

void add_model(io::JsonObject& report, const AnalysisRun& run, const SolutionSpace& space) {
  const TrimmedModel& m = run.model;
  const ModelSummary summary = summarise(m);
  io::JsonObject spans, light;
  spans.add("interior", summary.interior).add("trimmed", summary.trimmed);
  light.add("remedy", name_of(space.treatment().remedy)).add("threshold", space.treatment().threshold);
  light.add("functions", space.num_light());
  report.add("model", run.settings.model.string()).add("title", m.title).add("length_unit", m.length_unit);
  report.add("degree", m.grid.degree()).add("spans", spans).add("points", m.points.weights.size());
  report.add("unknowns", space.num_unknowns()).add("light_functions", light);
  const MaterialWords& words = run.settings.words;
  io::JsonObject material;
  material.add("name", words.name).add("source", words.source).add("unit_system", words.units ? words.units->name : "");
  if (words.E) material.add("E", *words.E).add("nu", *words.nu);
  if (words.rho) material.add("rho", *words.rho);
  if (const auto mass = mass_in_kg(words, summary.volume)) material.add("mass_in_kg", *mass);
  report.add("material", material);
}

void add_regions(TextReport& report, const std::vector<RegionReport>& regions) {
  for (const RegionReport& r : regions)
    report.line("support", "{}: {}, centroid ({:.6g}), {} points{}{}", r.name,
                r.extent == Extent::Surface ? fmt::format("area {:.8g}", r.area)
                : r.extent == Extent::Line  ? fmt::format("length {:.8g}", r.length)
                                            : "a point",
                fmt::join(r.centroid, ", "), r.points, r.note.empty() ? "" : "\n", r.note);
}

std::vector<io::JsonObject> json_of(const std::vector<RegionReport>& regions) {
  std::vector<io::JsonObject> list;
  for (const RegionReport& r : regions)
    list.push_back(io::JsonObject()
                       .add("name", r.name)
                       .add("area", r.area)
                       .add("length", r.length)
                       .add("centroid", r.centroid)
                       .add("points", r.points)
                       .add("note", r.note));
  return list;
}

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
  report.lines("model says", run.model.provenance.findings);
  report.lines("warning", run.warnings);
}

void add_end(io::JsonObject& report, const AnalysisRun& run) {
  if (!run.settings.output.empty()) report.add("output", run.settings.output.string());
  io::JsonObject timings;
  for (const auto& [stage, seconds] : run.timings) timings.add(stage, seconds);
  report.add("timings", timings).add("peak_memory_mib", peak_memory_mib()).add("warnings", run.warnings);
  report.add("findings", run.model.provenance.findings);
}

ResultsHeader results_header(const AnalysisRun& run, const char* analysis, const SolutionSpace& space) {
  ResultsHeader head;
  head.analysis = analysis;
  head.title = run.model.title;
  head.length_unit = run.model.length_unit;
  head.model_file = run.settings.model.filename().string();
  head.model_sha256 = io::sha256_file(run.settings.model);
  head.light_functions = name_of(space.treatment().remedy);
  head.light_threshold = space.treatment().threshold;
  head.unknowns = space.num_unknowns();
  head.density = run.settings.material.density;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) head.stiffness[static_cast<std::size_t>(6 * i + j)] = run.settings.material.C(i, j);
  Provenance& p = head.provenance;
  p.producer = "igasolve";
  p.version = program_version();
  p.command_line = run.command.text;
  p.inputs.push_back({head.model_file, head.model_sha256});
  if (!run.command.run_file.empty())
    p.inputs.push_back({run.command.run_file.filename().string(), io::sha256_file(run.command.run_file)});
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                          fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  p.timings = run.timings;
  p.findings = run.model.provenance.findings;
  p.warnings = run.warnings;
  return head;
}

void write_outputs(const AnalysisRun& run, const Results& results) {
  const OutputsBeingWritten writing;
  io::write_results(run.settings.output, results, run.command.force);
  if (run.settings.viewer) io::write_viewer_files(run.settings.output, results, run.command.force);
}

void print_report(const AnalysisRun& run, const std::string& report) {
  if (run.settings.progress) run.settings.progress->finish();
  if (run.command.style == ReportStyle::Quiet) return;
  io::write_report(fmt::format("{}{}", report, run.command.style == ReportStyle::Json ? "\n" : ""));
}

} // namespace iga::solve
