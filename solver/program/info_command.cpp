// igasolve info: grid, spans, points, functions, regions and provenance of a model.
#include "format/io/json_text.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "solver/program/commands.hpp"
#include "solver/report/memory_estimate.hpp"
#include "solver/report/model_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

constexpr std::size_t most_listed = 20; // of the edges and vertices of a CAD model

using io::JsonObject;

std::string text_report(const std::filesystem::path& file, const TrimmedModel& m, const ModelSummary& s,
                        const MemoryEstimate& need) {
  const std::string unit = m.length_unit == "unspecified" ? "" : " " + m.length_unit;
  const auto& q = m.quadrature;
  const auto n = m.grid.spans(), f = m.grid.functions();
  fmt::memory_buffer buffer;
  const auto line = [&]<class... A>(const char* key, fmt::format_string<A...> text, A&&... args) {
    fmt::format_to(std::back_inserter(buffer), "{:<12}{}\n", key, fmt::format(text, std::forward<A>(args)...));
  };
  line("file", "{}", file.string());
  if (!m.title.empty()) line("title", "{}", m.title);
  line("length unit", "{}", m.length_unit);
  line("grid", "{} spans of {:.6g}{}, degree {}, {} functions", fmt::join(n, " × "),
       fmt::join(m.grid.span_size(), " × "), unit, fmt::join(m.grid.degree(), " "), fmt::join(f, " × "));
  line("box", "A = ({:.6g}), B = ({:.6g}){}{}", fmt::join(m.grid.A(), ", "), fmt::join(m.grid.B(), ", "), unit,
       m.grid.rotation() == identity_rotation ? "" : ", rotated");
  line("spans", "{} interior, {} trimmed, {} exterior", s.interior, s.trimmed, s.exterior);
  line("cells", "{} in {} connected part{}; {} span{} several", m.num_cells(), s.cells.components,
       s.cells.components == 1 ? "" : "s", s.cells.split_spans, s.cells.split_spans == 1 ? " holds" : "s hold");
  line("points", "{}: {} in interior spans ({}), {} in trimmed spans ({}, {:.1f} per span)", s.points,
       s.interior_points, q.interior_rule, s.points - s.interior_points, q.trimmed_rule,
       s.trimmed ? static_cast<double>(s.points - s.interior_points) / static_cast<double>(s.trimmed) : 0.0);
  line("moments", "degree {}, largest residual {:.2g} of {:.2g} allowed", fmt::join(q.moment_degree, " "),
       q.max_residual, q.tolerance);
  line("volume", "{:.10g}{}; surface encloses {:.10g}", s.volume, unit.empty() ? "" : unit + "³", q.part_volume);
  if (q.snapped_spans) line("snapped", "{} spans, volume {:+.4g}", q.snapped_spans, q.snapped_volume);
  if (q.dropped_spans) line("dropped", "{} spans, volume {:.4g}", q.dropped_spans, -q.dropped_volume);
  line("centroid", "({:.8g})", fmt::join(s.centroid, ", "));
  line("functions",
       "{} touch material, {} of them light (mass fraction below {}), lightest {:.3g}; {} "
       "B-splines with a copy for each side of a gap",
       m.num_unknowns(), s.light_functions, light_below, s.lightest, s.cells.copied_functions);
  if (s.cells.gap_end_cells > 0)
    line("gap ends", "{} cells with functions that are continuous, not smooth, across faces", s.cells.gap_end_cells);
  line("surface", "{} triangles, {} vertices, {} quadrature points, area {:.10g}", m.surface.mesh.triangles.size(),
       m.surface.mesh.vertices.size(), s.surface_points, s.area);
  if (m.surface.accepted_leak > 0)
    line("leak", "accepted: {:.3g} span volumes; the surface's integrals are not checked", m.surface.accepted_leak);
  if (m.surface.bodies > 0) line("bodies", "{}", m.surface.bodies);
  for (const auto& region : s.regions)
    line("  region", "{}: {} triangles, area {:.10g}", region.name, region.triangles, region.area);
  for (std::size_t c = 0; c < std::min(m.curves.size(), most_listed); ++c)
    line("  curve", "{}: {} points, length {:.10g}", m.curves.names[c], m.curves.points_of(c).size(),
         polyline_length(m.curves.points_of(c)));
  const std::vector<std::string>& markers = m.markers.names;
  for (std::size_t i = 0; i < std::min(markers.size(), most_listed); ++i)
    line("  marker", "{}: ({:.8g})", markers[i], fmt::join(m.markers.positions[i], ", "));
  if (std::max(m.curves.size(), markers.size()) > most_listed)
    line("", "… {} curves and {} markers in all: --json lists them", m.curves.size(), markers.size());
  constexpr double GiB = 1024.0 * 1024 * 1024;
  line("memory",
       "igasolve eigen needs about {:.2g} GiB, static {:.2g} GiB (estimated from {:.2g} nonzeros of the factor)",
       need.eigen / GiB, need.statics / GiB, need.factor_nonzeros);
  const auto& p = m.provenance;
  line("made by", "{} {} at {}", p.producer, p.version, p.created);
  line("command", "{}", p.command_line);
  for (const auto& input : p.inputs) line("input", "{} (sha256 {})", input.name, input.sha256);
  line("settings", "sha256 {}", p.settings_sha256);
  for (const auto& [stage, seconds] : p.timings) line("timing", "{}: {:.3f} s", stage, seconds);
  for (const auto& finding : p.findings) line("finding", "{}", finding);
  for (const auto& warning : p.warnings) line("warning", "{}", warning);
  return fmt::to_string(buffer);
}

JsonObject provenance_object(const Provenance& p) {
  std::vector<JsonObject> inputs;
  for (const auto& input : p.inputs) inputs.push_back(JsonObject().add("name", input.name).add("sha256", input.sha256));
  JsonObject timings;
  for (const auto& [stage, seconds] : p.timings) timings.add(stage, seconds);
  JsonObject object;
  object.add("producer", p.producer)
      .add("version", p.version)
      .add("command_line", p.command_line)
      .add("created", p.created);
  object.add("inputs", inputs)
      .add("settings_sha256", p.settings_sha256)
      .add("timings", timings)
      .add("findings", p.findings)
      .add("warnings", p.warnings);
  return object;
}

std::string json_report(const std::filesystem::path& file, const TrimmedModel& m, const ModelSummary& s,
                        const MemoryEstimate& need) {
  const auto& q = m.quadrature;
  JsonObject grid, spans, points, volume, functions, surface, report;
  std::vector<double> rotation;
  for (const auto& row : m.grid.rotation()) rotation.insert(rotation.end(), row.begin(), row.end());
  grid.add("spans", m.grid.spans()).add("degree", m.grid.degree()).add("functions", m.grid.functions());
  grid.add("span_size", m.grid.span_size()).add("A", m.grid.A()).add("B", m.grid.B()).add("rotation", rotation);
  spans.add("interior", s.interior).add("trimmed", s.trimmed).add("exterior", s.exterior);
  points.add("total", s.points).add("interior", s.interior_points).add("trimmed", s.points - s.interior_points);
  points.add("interior_rule", q.interior_rule)
      .add("trimmed_rule", q.trimmed_rule)
      .add("moment_degree", q.moment_degree);
  points.add("tolerance", q.tolerance).add("max_residual", q.max_residual);
  volume.add("weights", s.volume)
      .add("part", q.part_volume)
      .add("snapped", q.snapped_volume)
      .add("dropped", q.dropped_volume);
  volume.add("snapped_spans", q.snapped_spans).add("dropped_spans", q.dropped_spans).add("centroid", s.centroid);
  functions.add("active", m.num_unknowns()).add("light", s.light_functions).add("light_below", light_below);
  functions.add("lightest", s.lightest).add("copied", s.cells.copied_functions);
  functions.add("gap_end_cells", s.cells.gap_end_cells);
  std::vector<JsonObject> regions;
  for (const auto& r : s.regions)
    regions.push_back(JsonObject().add("name", r.name).add("triangles", r.triangles).add("area", r.area));
  surface.add("triangles", m.surface.mesh.triangles.size()).add("vertices", m.surface.mesh.vertices.size());
  surface.add("points", s.surface_points)
      .add("area", s.area)
      .add("accepted_leak", m.surface.accepted_leak)
      .add("bodies", m.surface.bodies)
      .add("regions", regions);
  report.add("file", file.string()).add("title", m.title).add("length_unit", m.length_unit).add("grid", grid);
  report.add("cells", JsonObject()
                          .add("total", m.num_cells())
                          .add("split_spans", s.cells.split_spans)
                          .add("components", s.cells.components));
  report.add("spans", spans)
      .add("points", points)
      .add("volume", volume)
      .add("functions", functions)
      .add("surface", surface);
  std::vector<JsonObject> curves, markers;
  for (std::size_t c = 0; c < m.curves.size(); ++c)
    curves.push_back(JsonObject()
                         .add("name", m.curves.names[c])
                         .add("points", m.curves.points_of(c).size())
                         .add("length", polyline_length(m.curves.points_of(c))));
  for (std::size_t i = 0; i < m.markers.names.size(); ++i)
    markers.push_back(JsonObject().add("name", m.markers.names[i]).add("position", m.markers.positions[i]));
  report.add("curves", curves).add("markers", markers);
  report.add("memory_estimate", JsonObject()
                                    .add("eigen_bytes", need.eigen)
                                    .add("static_bytes", need.statics)
                                    .add("factor_nonzeros", need.factor_nonzeros));
  report.add("provenance", provenance_object(m.provenance));
  report.add("findings", m.provenance.findings).add("warnings", m.provenance.warnings);
  return report.text() + "\n";
}

} // namespace

int run_info(const ModelCommand& command) {
  const TrimmedModel model = io::read_model(command.model);
  if (command.style == ReportStyle::Quiet) return io::exit_done;
  const ModelSummary summary = summarise(model);
  const MemoryEstimate need = estimate_memory(model);
  io::write_report(command.style == ReportStyle::Json ? json_report(command.model, model, summary, need)
                                                      : text_report(command.model, model, summary, need));
  return io::exit_done;
}

} // namespace iga::solve
