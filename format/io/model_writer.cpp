#include "format/io/control_points.hpp"
#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/io/provenance_io.hpp"
#include "format/io/trimmed_model_io.hpp"

namespace iga::io {

namespace {

void write_patch(H5Writer& file, const SplineGrid& grid) {
  file.group(names::patch, "the B-spline grid: x(u) = sum N_i(u) P_i = C + R (u - C), C = (A + B) / 2");
  const auto degree = grid.degree();
  const std::array<std::int32_t, 3> p{degree[0], degree[1], degree[2]};
  const Index3 spans = grid.spans();
  const Rotation& R = grid.rotation();
  file.attribute<std::int32_t>(names::patch, "degree", {3}, p);
  file.attribute<std::int64_t>(names::patch, "spans", {3}, spans);
  file.attribute<double>(names::patch, "A", {3}, grid.A());
  file.attribute<double>(names::patch, "B", {3}, grid.B());
  file.attribute<double>(names::patch, "rotation", {3, 3}, std::span(R.front().data(), 9));
  for (int d = 0; d < 3; ++d) {
    const auto knots = grid.knots(d).values();
    file.dataset(names::knots[static_cast<std::size_t>(d)], {static_cast<std::int64_t>(knots.size())}, knots);
  }
  if (grid.num_functions() > names::most_control_points) return;
  const ControlPoints points(grid);
  file.rows(names::control_points, grid.num_functions(), 3,
            [&](std::int64_t first, std::span<double> block) { points.fill(first, block); });
}

void write_spans(H5Writer& file, const TrimmedModel& m) {
  const Index3 n = m.grid.spans();
  file.group(names::spans, "which knot spans hold material");
  file.enums(names::state, {n[2], n[1], n[0]}, m.state, names::states);
}

void write_cells(H5Writer& file, const TrimmedModel& m) {
  const auto n = static_cast<std::int64_t>(m.num_cells());
  file.group(names::cells, "what an analysis loops over: one piece of one span each");
  write(file, names::cell_span, m.cells.span);
  file.enums(names::cell_state, {n}, m.cells.state, names::states);
  write(file, names::volume_fraction, m.cells.volume_fraction);
  write(file, names::cell_functions, m.cells.functions,
        n > 0 ? static_cast<std::int64_t>(m.cells.functions.size()) / n : 0);
  file.group(names::links, "which cells hang together");
  write(file, names::link_cells, m.links.cells, 2);
}

void write_quadrature(H5Writer& file, const TrimmedModel& m) {
  const char* group = names::quadrature;
  const QuadratureInfo& q = m.quadrature;
  const std::array<std::int32_t, 3> moment_degree{q.moment_degree[0], q.moment_degree[1], q.moment_degree[2]};
  file.group(group, "quadrature of the solid: points inside it with positive weights");
  file.attribute(group, "interior_rule", q.interior_rule);
  file.attribute(group, "trimmed_rule", q.trimmed_rule);
  file.attribute(group, "surface_rule", q.surface_rule);
  file.attribute<std::int32_t>(group, "moment_degree", {3}, moment_degree);
  file.attribute(group, "tolerance", q.tolerance);
  file.attribute(group, "max_residual", q.max_residual);
  file.attribute(group, "sliver_tolerance", q.sliver_tolerance);
  file.attribute(group, "min_fraction", q.min_fraction);
  file.attribute(group, "part_volume", q.part_volume);
  file.attribute(group, "snapped_volume", q.snapped_volume);
  file.attribute(group, "dropped_volume", q.dropped_volume);
  file.attribute(group, "snapped_spans", q.snapped_spans);
  file.attribute(group, "dropped_spans", q.dropped_spans);
  write(file, names::point_offsets, m.points.offsets);
  write(file, names::point_parameters, m.points.parameters, 3);
  write(file, names::point_weights, m.points.weights);
  write(file, names::residual, m.points.residual);
}

void write_functions(H5Writer& file, const TrimmedModel& m) {
  file.group(names::functions, "the functions that carry the solution: copies of the B-splines that touch material");
  write(file, names::function_number, m.functions.number);
  write(file, names::mass_fraction, m.functions.mass_fraction);
}

void write_unknowns(H5Writer& file, const Unknowns& u) {
  if (u.empty()) return;
  file.group(names::unknowns,
             "coefficients of functions from unknowns, where gaps end inside the support of B-splines; "
             "without this group every function is an unknown");
  write(file, names::unknown_offsets, u.offsets);
  write(file, names::unknown_terms, u.terms);
  write(file, names::unknown_weights, u.weights);
  write(file, names::unknown_function, u.function);
  write(file, names::unknown_parameters, u.parameters, 3);
  write(file, names::unknown_mass_fraction, u.mass_fraction);
}

void write_points(H5Writer& file, const DatasetText& text, const std::vector<Point3>& points) {
  file.dataset(text, {static_cast<std::int64_t>(points.size()), 3}, flat(points));
}

void write_places(H5Writer& file, const TrimmedModel& m) {
  if (!m.curves.empty()) {
    file.group(names::curves, "named lines in space that supports and loads may act along");
    file.strings(names::curve_names, m.curves.names);
    write(file, names::curve_offsets, m.curves.offsets);
    write_points(file, names::curve_points, m.curves.points);
  }
  if (!m.markers.empty()) {
    file.group(names::markers, "named points in space that supports and loads may act at");
    file.strings(names::marker_names, m.markers.names);
    write_points(file, names::marker_positions, m.markers.positions);
  }
}

void write_surface(H5Writer& file, const EmbeddedSurface& s) {
  file.group(names::surface, "the embedded surface, tied to the grid");
  file.attribute(names::surface, "accepted_leak", s.accepted_leak);
  if (s.bodies > 0) file.attribute(names::surface, "bodies", s.bodies);
  write_points(file, names::vertices, s.mesh.vertices);
  write(file, names::vertex_parameters, s.vertex_parameters, 3);
  write(file, names::vertex_cell, s.vertex_cell);
  file.dataset(names::triangles, {static_cast<std::int64_t>(s.mesh.triangles.size()), 3}, flat(s.mesh.triangles));
  write(file, names::region, s.mesh.region);
  file.strings(names::regions, s.mesh.region_names);
  file.group(names::surface_quadrature, "quadrature of the surface: its triangles cut at the span faces");
  write(file, names::surface_offsets, s.quadrature.offsets);
  write(file, names::surface_parameters, s.quadrature.parameters, 3);
  write(file, names::surface_weights, s.quadrature.weights);
  write(file, names::surface_normals, s.quadrature.normals, 3);
  write(file, names::surface_triangle, s.quadrature.triangle);
}

} // namespace

void write_model(const std::filesystem::path& path, const TrimmedModel& model) {
  H5Writer file(path);
  file.attribute(names::root, "format", std::string(names::format));
  file.attribute(names::root, "format_version", std::string(names::format_version));
  file.attribute(names::root, "length_unit", model.length_unit);
  file.attribute(names::root, "title", model.title);
  write_patch(file, model.grid);
  write_spans(file, model);
  write_cells(file, model);
  write_quadrature(file, model);
  write_functions(file, model);
  write_unknowns(file, model.unknowns);
  write_surface(file, model.surface);
  write_places(file, model);
  write_provenance(file, model.provenance);
  file.commit();
}

} // namespace iga::io
