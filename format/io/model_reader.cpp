#include "format/io/control_points.hpp"
#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/io/provenance_io.hpp"
#include "format/io/trimmed_model_io.hpp"

#include "format/model/errors.hpp"

#include <cmath>
#include <fmt/format.h>
#include <new>

namespace iga::io {

namespace {

// Knots and control points of another producer may differ from ours by rounding; more would move points between spans.
constexpr double place_tolerance = 1e-9; // in spans
// Beyond this number of spans their linear numbers and the sums over them would no longer be safe.
constexpr std::int64_t most_spans = std::int64_t{1} << 40;

SplineGrid read_grid(const H5Reader& file) {
  const auto degree = file.numbers<std::int32_t>(names::patch, "degree", {3});
  const auto spans = file.numbers<std::int64_t>(names::patch, "spans", {3});
  const auto A = file.numbers<double>(names::patch, "A", {3}), B = file.numbers<double>(names::patch, "B", {3});
  const auto R = file.numbers<double>(names::patch, "rotation", {3, 3});
  std::int64_t total = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    if (degree[d] < 1 || degree[d] > max_degree)
      file.refuse("/patch attribute degree", fmt::format("holds {}, expected 1 ... {}", degree[d], max_degree));
    if (spans[d] < 1 || spans[d] > most_spans || (total *= spans[d]) > most_spans)
      file.refuse("/patch attribute spans",
                  fmt::format("is ({}, {}, {}), expected counts of at least 1 and {} spans at most", spans[0], spans[1],
                              spans[2], most_spans));
    // Before a grid is made: a false count must not ask for the memory of its knots.
    const Shape knots{spans[d] + 2 * degree[d] + 1};
    if (const Shape found = file.shape(names::knots[d].path, 1); found != knots)
      file.refuse(names::knots[d].path,
                  fmt::format("has shape ({}), expected ({}): n_spans + 2 degree + 1", found[0], knots[0]));
  }
  Rotation rotation{};
  for (std::size_t i = 0; i < 9; ++i) rotation[i / 3][i % 3] = R[i];
  try {
    return {{A[0], A[1], A[2]},
            {B[0], B[1], B[2]},
            {spans[0], spans[1], spans[2]},
            {degree[0], degree[1], degree[2]},
            rotation};
  } catch (const InputError& error) {
    file.refuse(names::patch, error.what());
  }
}

void check_knots(const H5Reader& file, const SplineGrid& grid) {
  for (std::size_t d = 0; d < 3; ++d) {
    const char* path = names::knots[d].path;
    const auto expected = grid.knots(static_cast<int>(d)).values();
    const auto found = read<double>(file, names::knots[d], static_cast<std::int64_t>(expected.size()));
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i > 0 && !(found[i] >= found[i - 1]))
        file.refuse(path,
                    fmt::format("knot {} is {}, expected at least the one before, {}", i, found[i], found[i - 1]));
      if (!(std::abs(found[i] - expected[i]) <= place_tolerance * grid.span_size()[d]))
        file.refuse(path, fmt::format("knot {} is {:.17g}, expected {:.17g} (equal spans from A to B)", i, found[i],
                                      expected[i]));
    }
  }
}

void check_control_points(const H5Reader& file, const SplineGrid& grid) {
  if (grid.num_functions() > names::most_control_points && !file.has(names::control_points.path)) return;
  const ControlPoints points(grid);
  const auto h = grid.span_size();
  const double slack = place_tolerance * std::min({h[0], h[1], h[2]});
  std::vector<double> expected;
  file.rows(
      names::control_points.path, grid.num_functions(), 3, [&](std::int64_t first, std::span<const double> block) {
        expected.resize(block.size());
        points.fill(first, expected);
        for (std::size_t i = 0; i < block.size(); ++i)
          if (!(std::abs(block[i] - expected[i]) <= slack))
            file.refuse(
                names::control_points.path,
                fmt::format("control point {}, {} is {:.17g}, expected {:.17g} (position of the Greville parameters)",
                            first + static_cast<std::int64_t>(i / 3), "xyz"[i % 3], block[i], expected[i]));
      });
}

QuadratureInfo read_quadrature_info(const H5Reader& file) {
  const char* group = names::quadrature;
  QuadratureInfo q;
  q.interior_rule = file.text(group, "interior_rule");
  q.trimmed_rule = file.text(group, "trimmed_rule");
  if (file.has_attribute(group, "surface_rule")) q.surface_rule = file.text(group, "surface_rule");
  const auto moment_degree = file.numbers<std::int32_t>(group, "moment_degree", {3});
  q.moment_degree = {moment_degree[0], moment_degree[1], moment_degree[2]};
  q.tolerance = file.number<double>(group, "tolerance");
  q.max_residual = file.number<double>(group, "max_residual");
  q.sliver_tolerance = file.number<double>(group, "sliver_tolerance");
  q.min_fraction = file.number<double>(group, "min_fraction");
  q.part_volume = file.number<double>(group, "part_volume");
  q.snapped_volume = file.number<double>(group, "snapped_volume");
  q.dropped_volume = file.number<double>(group, "dropped_volume");
  q.snapped_spans = file.number<std::int64_t>(group, "snapped_spans");
  q.dropped_spans = file.number<std::int64_t>(group, "dropped_spans");
  return q;
}

IntegrationPoints read_points(const H5Reader& file, std::int64_t num_cells) {
  IntegrationPoints points;
  const std::int64_t n = rows_of(file, names::point_weights);
  points.offsets = read<std::int64_t>(file, names::point_offsets, num_cells + 1);
  points.parameters = read<double>(file, names::point_parameters, n, 3);
  points.weights = read<double>(file, names::point_weights, n);
  points.residual = read<double>(file, names::residual, num_cells);
  return points;
}

SurfacePoints read_surface_points(const H5Reader& file, std::int64_t num_cells) {
  SurfacePoints points;
  const std::int64_t n = rows_of(file, names::surface_weights);
  points.offsets = read<std::int64_t>(file, names::surface_offsets, num_cells + 1);
  points.parameters = read<double>(file, names::surface_parameters, n, 3);
  points.weights = read<double>(file, names::surface_weights, n);
  points.normals = read<double>(file, names::surface_normals, n, 3);
  points.triangle = read<std::int32_t>(file, names::surface_triangle, n);
  return points;
}

EmbeddedSurface read_surface(const H5Reader& file, std::int64_t num_cells) {
  EmbeddedSurface s;
  const std::int64_t num_vertices = rows_of(file, names::vertices, 2),
                     num_triangles = rows_of(file, names::triangles, 2);
  s.accepted_leak = file.number<double>(names::surface, "accepted_leak");
  if (file.has_attribute(names::surface, "bodies")) s.bodies = file.number<std::int64_t>(names::surface, "bodies");
  s.mesh.vertices = in_rows<Point3>(read<double>(file, names::vertices, num_vertices, 3));
  s.mesh.triangles = in_rows<Triangle>(read<std::int32_t>(file, names::triangles, num_triangles, 3));
  s.mesh.region = read<std::int32_t>(file, names::region, num_triangles);
  s.mesh.region_names = file.strings(names::regions.path);
  s.vertex_parameters = read<double>(file, names::vertex_parameters, num_vertices, 3);
  s.vertex_cell = read<std::int64_t>(file, names::vertex_cell, num_vertices);
  s.quadrature = read_surface_points(file, num_cells);
  return s;
}

Unknowns read_unknowns(const H5Reader& file, std::int64_t num_functions) {
  Unknowns u;
  if (!file.has(names::unknowns)) return u;
  const std::int64_t n = rows_of(file, names::unknown_function), terms = rows_of(file, names::unknown_terms);
  u.offsets = read<std::int64_t>(file, names::unknown_offsets, num_functions + 1);
  u.terms = read<std::int32_t>(file, names::unknown_terms, terms);
  u.weights = read<double>(file, names::unknown_weights, terms);
  u.function = read<std::int32_t>(file, names::unknown_function, n);
  u.parameters = read<double>(file, names::unknown_parameters, n, 3);
  u.mass_fraction = read<double>(file, names::unknown_mass_fraction, n);
  return u;
}

Curves read_curves(const H5Reader& file) {
  Curves c;
  if (!file.has(names::curves)) return c;
  const std::int64_t n = rows_of(file, names::curve_names), points = rows_of(file, names::curve_points, 2);
  c.names = file.strings(names::curve_names.path);
  c.offsets = read<std::int64_t>(file, names::curve_offsets, n + 1);
  c.points = in_rows<Point3>(read<double>(file, names::curve_points, points, 3));
  return c;
}

Markers read_markers(const H5Reader& file) {
  Markers m;
  if (!file.has(names::markers)) return m;
  const std::int64_t n = rows_of(file, names::marker_names);
  m.names = file.strings(names::marker_names.path);
  m.positions = in_rows<Point3>(read<double>(file, names::marker_positions, n, 3));
  return m;
}

TrimmedModel load(const H5Reader& file) {
  expect_format(file, names::format, names::format_major, names::format_version);
  TrimmedModel m;
  m.length_unit = file.text(names::root, "length_unit");
  m.title = file.text(names::root, "title");
  m.grid = read_grid(file);
  check_knots(file, m.grid);
  check_control_points(file, m.grid);
  const Index3 n = m.grid.spans();
  const auto p = m.grid.degree();
  const std::int64_t num_cells = rows_of(file, names::cell_span), num_links = rows_of(file, names::link_cells, 2);
  m.state = file.enums(names::state.path, {n[2], n[1], n[0]}, names::states);
  m.cells.span = read<std::int64_t>(file, names::cell_span, num_cells);
  m.cells.state = file.enums(names::cell_state.path, {num_cells}, names::states);
  m.cells.volume_fraction = read<double>(file, names::volume_fraction, num_cells);
  m.cells.functions = read<std::int32_t>(file, names::cell_functions, num_cells, (p[0] + 1) * (p[1] + 1) * (p[2] + 1));
  m.links.cells = read<std::int32_t>(file, names::link_cells, num_links, 2);
  m.quadrature = read_quadrature_info(file);
  m.points = read_points(file, num_cells);
  const std::int64_t num_functions = rows_of(file, names::function_number);
  m.functions.number = read<std::int64_t>(file, names::function_number, num_functions);
  m.functions.mass_fraction = read<double>(file, names::mass_fraction, num_functions);
  m.unknowns = read_unknowns(file, num_functions);
  m.surface = read_surface(file, num_cells);
  m.curves = read_curves(file);
  m.markers = read_markers(file);
  m.provenance = read_provenance(file);
  return m;
}

} // namespace

TrimmedModel load_model(const std::filesystem::path& path) {
  const H5Reader file(path);
  try {
    return load(file);
  } catch (const std::bad_alloc&) {
    throw InputError(
        fmt::format("{}: holds more data than fits into the memory that is free; close other programs, use "
                    "a machine with more memory, or make a smaller file with larger spans",
                    path.string()));
  }
}

TrimmedModel read_model(const std::filesystem::path& path) {
  TrimmedModel model = load_model(path);
  const auto problems = check(model);
  if (problems.empty()) return model;
  std::string text = fmt::format("{}: breaks the format's promises:", path.string());
  for (const auto& problem : problems) text += "\n  " + problem;
  throw FormatError(text);
}

std::string read_length_unit(const std::filesystem::path& path) {
  const H5Reader file(path);
  expect_format(file, names::format, names::format_major, names::format_version);
  return file.text(names::root, "length_unit");
}

Provenance read_provenance(const std::filesystem::path& path) {
  const H5Reader file(path);
  expect_format(file, names::format, names::format_major, names::format_version);
  return read_provenance(file);
}

} // namespace iga::io
