#include "preprocessor/program/report.hpp"

#include "format/io/json_text.hpp"
#include "preprocessor/program/gates.hpp"
#include "preprocessor/trim/optimise_offset.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <sys/resource.h>

namespace iga::prep {

namespace {

constexpr double shown_seconds = 0.01; // shorter stages do not matter to the reader
constexpr std::size_t most_surface_samples = 10000;

std::string text(const Point3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

Point3 sides_of(const Box3& box) {
  return {box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]};
}

std::string times(const Index3& n) {
  return fmt::format("{} × {} × {}", n[0], n[1], n[2]);
}

std::string count(std::int64_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

double total_seconds(const PrepReport& r) {
  double sum = 0;
  for (const auto& [stage, seconds] : r.timings) sum += seconds;
  return sum;
}

void compare_moments(PrepReport& r) {
  const Point3 side = sides_of(r.part_box);
  const auto& a = r.surface;
  const auto& b = r.points_moments;
  const Point3 apart{a.centroid[0] - b.centroid[0], a.centroid[1] - b.centroid[1], a.centroid[2] - b.centroid[2]};
  r.centroid_error = std::hypot(apart[0], apart[1], apart[2]) / std::hypot(side[0], side[1], side[2]);
  const double trace = a.second_moments[0] + a.second_moments[1] + a.second_moments[2];
  r.inertia_error = 0;
  for (std::size_t e = 0; e < 6; ++e)
    r.inertia_error = std::max(r.inertia_error, std::abs(a.second_moments[e] - b.second_moments[e]) / trace);
}

// Walls and gaps that the spans are too coarse for; null where there are none.
void add_walls_and_gaps(io::JsonObject& json, const PrepReport& r) {
  const auto add = [&](const char* key, const auto& found, const auto& add_own) {
    if (!found) {
      json.add(key, std::numeric_limits<double>::quiet_NaN());
      return;
    }
    io::JsonObject place;
    add_own(place);
    place.add("spans", found->spans);
    place.add("where", found->where);
    place.add("span_size", found->span_size);
    place.add("num_spans", found->num_spans);
    json.add(key, place);
  };
  const auto& wall = r.walls.thinnest;
  add("thinnest_wall", wall, [&](io::JsonObject& own) {
    own.add("thickness", wall->thickness);
    own.add("taper", wall->taper);
  });
  json.add("thin_wall_volume_share", r.walls.volume_share);
  const auto& gap = r.narrowest_gap;
  add("narrowest_gap", gap, [&](io::JsonObject& own) { own.add("width", gap->width); });
}

// What only the run knows that made the file.
void add_run(io::JsonObject& json, const PrepReport& r) {
  json.add("format", r.format);
  json.add("bodies", r.bodies);
  json.add("cavities", r.cavities);
  json.add("pieces", r.pieces);
  json.add("trimming_volume_error", r.trimming_error);
  json.add("interior_boxes", r.counts.interior_boxes);
  json.add("box_spans", r.counts.box_spans);
  json.add("prism_spans", r.counts.prism_spans);
  json.add("fitted_spans", r.counts.fitted_spans);
  json.add("refined_spans", r.counts.refined_spans);
  json.add("removed_by_newton", r.counts.reduction.newton);
  json.add("removed_by_bounded_descent", r.counts.reduction.bounded);
  json.add("stalled_spans", r.counts.reduction.stalls);
  json.add("unreduced_spans", r.counts.reduction.unchanged);
  json.add("stabilised_spans", r.counts.stabilised_spans);
  json.add("kept_spans", r.counts.kept_spans);
  if (r.offset) {
    io::JsonObject offset;
    offset.add("light_before", r.offset->light_before);
    offset.add("light_after", r.offset->light_after);
    offset.add("evaluations", r.offset->evaluations);
    json.add("offset", offset);
  }
  io::JsonObject timings;
  for (const auto& [stage, seconds] : r.timings) timings.add(stage, seconds);
  timings.add("total", total_seconds(r));
  json.add("timings", timings);
}

} // namespace

void describe_model(PrepReport& r, const TrimmedModel& model) {
  r.length_unit = model.length_unit;
  r.grid = model.grid;
  r.quadrature = model.quadrature;
  const TriangleMesh& mesh = model.surface.mesh;
  r.part_box = bounding_box(mesh);
  r.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  r.regions = static_cast<int>(mesh.region_names.size());
  r.area = surface_area(mesh);
  r.surface = volume_moments(mesh);
  const auto& areas = model.surface.quadrature.weights;
  r.surface_points = static_cast<std::int64_t>(areas.size());
  r.area_error = std::abs(std::accumulate(areas.begin(), areas.end(), 0.0) - r.area) / r.area;

  const auto count_state = [&](SpanState s) {
    return std::count(model.state.begin(), model.state.end(), static_cast<std::uint8_t>(s));
  };
  r.interior = count_state(SpanState::Interior);
  r.trimmed = count_state(SpanState::Trimmed);
  r.exterior = model.grid.num_spans() - r.interior - r.trimmed;
  r.points = static_cast<std::int64_t>(model.points.weights.size());
  r.points_interior = 0;
  for (std::size_t a = 0; a < model.cells.span.size(); ++a)
    if (model.is_interior(a)) r.points_interior += model.points.offsets[a + 1] - model.points.offsets[a];
  r.points_trimmed = r.points - r.points_interior;
  r.functions = static_cast<std::int64_t>(model.num_unknowns());
  r.light_functions = std::count_if(model.unknown_mass_fraction().begin(), model.unknown_mass_fraction().end(),
                                    [](double chi) { return chi < light_mass_fraction; });

  const CellCounts cells = count_cells(model);
  r.cells = static_cast<std::int64_t>(model.num_cells());
  r.split_spans = cells.split_spans;
  r.copied_functions = cells.copied_functions;
  r.gap_end_cells = cells.gap_end_cells;
  r.components = cells.components;

  r.points_moments = point_moments(model.grid, model.points, r.surface.centroid);
  const QuadratureInfo& q = model.quadrature;
  r.volume_error = std::abs(r.points_moments.volume - (q.part_volume + q.snapped_volume - q.dropped_volume)) /
                   std::abs(q.part_volume);
  compare_moments(r);
}

void measure_walls_and_gaps(PrepReport& r, const TrimmedModel& model, const TriangleTree& tree) {
  const std::vector<SurfaceSample> samples = sample_surface(model, most_surface_samples);
  r.walls = find_thin_walls(model, tree, samples);
  r.narrowest_gap = find_narrow_gap(model, tree, samples);
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string human_report(const PrepReport& r) {
  if (r.reused)
    return fmt::format(
        "{} already holds {} with these settings (same input bytes, settings and version): nothing to do\n", r.output,
        r.input);
  std::string out;
  const auto line = [&](const char* name, const std::string& value) { out += fmt::format("{:<12}{}\n", name, value); };
  const std::string unit = r.length_unit == "unspecified" ? "" : " " + r.length_unit;
  line("part", fmt::format("{}, {}", r.input, r.format));
  line("box", fmt::format("{:.6g} × {:.6g} × {:.6g}{}, from {} to {}", sides_of(r.part_box)[0], sides_of(r.part_box)[1],
                          sides_of(r.part_box)[2], unit, text(r.part_box.lower), text(r.part_box.upper)));
  line("surface",
       fmt::format("{} triangles, {}, {}, {}, area {:.6g}", r.triangles, count(r.regions, "region", "regions"),
                   count(r.bodies, "body", "bodies"), count(r.cavities, "cavity", "cavities"), r.area));
  const Point3 h = r.grid.span_size();
  line("grid", fmt::format("{} spans of {:.6g} × {:.6g} × {:.6g}, degree {} {} {}", times(r.grid.spans()), h[0], h[1],
                           h[2], r.grid.degree()[0], r.grid.degree()[1], r.grid.degree()[2]));
  line("spans", fmt::format("{} interior, {} trimmed, {} exterior", r.interior, r.trimmed, r.exterior));
  if (r.quadrature.snapped_spans > 0)
    line("snapped", fmt::format("{} spans, volume {:+.3g}", r.quadrature.snapped_spans, r.quadrature.snapped_volume));
  if (r.quadrature.dropped_spans > 0)
    line("dropped", fmt::format("{} spans, volume {:.3g}", r.quadrature.dropped_spans, r.quadrature.dropped_volume));
  line("points", fmt::format("{} ({} interior, {} trimmed), {} on the surface", r.points, r.points_interior,
                             r.points_trimmed, r.surface_points));
  line("inside", r.counts.interior_boxes > 0
                     ? fmt::format("{} on {} of spans, {:.3g} points per span", r.quadrature.interior_rule,
                                   count(r.counts.interior_boxes, "box", "boxes"),
                                   static_cast<double>(r.points_interior) / static_cast<double>(r.interior))
                     : fmt::format("{} in every span", r.quadrature.interior_rule));
  line("rules",
       fmt::format("{} boxes, {} prisms, {} fitted ({} with more candidates), moment degree {} {} {}",
                   r.counts.box_spans, r.counts.prism_spans, r.counts.fitted_spans, r.counts.refined_spans,
                   r.quadrature.moment_degree[0], r.quadrature.moment_degree[1], r.quadrature.moment_degree[2]));
  const ReductionCounts& reduction = r.counts.reduction;
  if (r.trimmed > 0)
    line("fewer",
         fmt::format("{}: {:.3g} points per trimmed span, {} removed; {} got extra points against zero-energy modes",
                     r.quadrature.trimmed_rule, static_cast<double>(r.points_trimmed) / static_cast<double>(r.trimmed),
                     reduction.newton + reduction.bounded, count(r.counts.stabilised_spans, "span", "spans")));
  line("residual", fmt::format("{:.2e} at most (allowed {:.0e})", r.quadrature.max_residual, r.quadrature.tolerance));
  line("volume", fmt::format("{:.10g}, surface {:.10g}: trimming off by {:.1e}, points by {:.1e}",
                             r.points_moments.volume, r.surface.volume, r.trimming_error, r.volume_error));
  line("moments", fmt::format("points against surface: centroid {:.1e}, inertia {:.1e}, area {:.1e}", r.centroid_error,
                              r.inertia_error, r.area_error));
  line("cells",
       fmt::format("{} in {}, {} {} several", r.cells, count(r.components, "connected part", "connected parts"),
                   count(r.split_spans, "span", "spans"), r.split_spans == 1 ? "holds" : "hold"));
  if (r.gap_end_cells > 0)
    line("gap ends",
         fmt::format("{} with functions that are continuous but not smooth across faces, so that walls move "
                     "on their own up to the end of a gap",
                     count(r.gap_end_cells, "cell", "cells")));
  line("functions", fmt::format("{} with material, {} light; {} with a copy for each side of a gap", r.functions,
                                r.light_functions, count(r.copied_functions, "B-spline", "B-splines")));
  if (const auto& w = r.walls.thinnest)
    line("walls",
         fmt::format("thinnest {:.4g}, {:.3g} spans, near {}; {:.3g} % of the volume in walls that want {} spans",
                     w->thickness, w->spans, text(w->where), 100 * r.walls.volume_share, spans_across_wall(r.grid)));
  if (const auto& gap = r.narrowest_gap)
    line("gaps", fmt::format("narrowest {:.4g}, {:.3g} spans, near {}", gap->width, gap->spans, text(gap->where)));
  if (r.offset)
    line("offset", fmt::format("light functions (estimated) {} → {} by shifting the grid, {} grids tried",
                               r.offset->light_before, r.offset->light_after, r.offset->evaluations));
  for (const std::string& finding : r.findings) line("found", finding);
  std::string stages;
  for (const auto& [stage, seconds] : r.timings)
    if (seconds >= shown_seconds) stages += fmt::format("{}{} {:.2f}", stages.empty() ? ": " : ", ", stage, seconds);
  line("time", fmt::format("{:.2f} s{}", total_seconds(r), stages));
  line("memory", fmt::format("{:.0f} MiB at most", r.peak_memory_mib));
  line("written", r.output);
  return out;
}

std::string json_report(const PrepReport& r) {
  io::JsonObject json;
  json.add("input", r.input);
  json.add("output", r.output);
  json.add("reused", r.reused);
  json.add("length_unit", r.length_unit);
  json.add("volume", r.points_moments.volume);
  json.add("mesh_volume", r.surface.volume);
  json.add("volume_error", r.volume_error);
  json.add("centroid", r.points_moments.centroid);
  json.add("centroid_error", r.centroid_error);
  json.add("second_moments", r.points_moments.second_moments);
  json.add("inertia_error", r.inertia_error);
  json.add("area", r.area);
  json.add("area_error", r.area_error);
  io::JsonObject spans;
  spans.add("interior", r.interior);
  spans.add("trimmed", r.trimmed);
  spans.add("exterior", r.exterior);
  json.add("spans", spans);
  json.add("points", r.points);
  json.add("points_interior", r.points_interior);
  json.add("points_trimmed", r.points_trimmed);
  json.add("surface_points", r.surface_points);
  json.add("max_residual", r.quadrature.max_residual);
  json.add("snapped_spans", r.quadrature.snapped_spans);
  json.add("snapped_volume", r.quadrature.snapped_volume);
  json.add("dropped_spans", r.quadrature.dropped_spans);
  json.add("dropped_volume", r.quadrature.dropped_volume);
  json.add("triangles", r.triangles);
  json.add("regions", r.regions);
  json.add("cells", r.cells);
  json.add("split_spans", r.split_spans);
  json.add("gap_end_cells", r.gap_end_cells);
  json.add("components", r.components);
  json.add("functions", r.functions);
  json.add("copied_functions", r.copied_functions);
  json.add("light_functions", r.light_functions);
  add_walls_and_gaps(json, r);
  json.add("findings", r.findings);
  json.add("warnings", r.warnings);
  io::JsonObject grid;
  grid.add("A", r.grid.A());
  grid.add("B", r.grid.B());
  grid.add("spans", r.grid.spans());
  grid.add("degree", r.grid.degree());
  grid.add("span_size", r.grid.span_size());
  const Rotation& R = r.grid.rotation();
  grid.add("rotation",
           std::array<double, 9>{R[0][0], R[0][1], R[0][2], R[1][0], R[1][1], R[1][2], R[2][0], R[2][1], R[2][2]});
  json.add("grid", grid);
  if (!r.reused) add_run(json, r);
  json.add("peak_memory_mib", r.peak_memory_mib);
  return json.text();
}

} // namespace iga::prep
