#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/io/provenance_io.hpp"
#include "format/io/result_names.hpp"
#include "format/io/results_io.hpp"

#include "format/model/errors.hpp"
#include "format/model/time_series.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <new>
#include <numbers>

namespace iga::io {

namespace {

namespace result = result_names;

// Numbers of a results file are finite without exception.
std::vector<double> finite(const H5Reader& file, const DatasetText& text, const Shape& shape) {
  auto values = file.dataset<double>(text.path, shape);
  const auto bad = std::find_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); });
  if (bad != values.end())
    file.refuse(text.path, fmt::format("value {} is {}, expected a finite number", bad - values.begin(), *bad));
  return values;
}

void expect_ascending(const H5Reader& file, const DatasetText& text, const auto& values) {
  const auto fall = std::adjacent_find(values.begin(), values.end(), [](auto a, auto b) { return !(a <= b); });
  if (fall != values.end())
    file.refuse(text.path, fmt::format("value {} is {}, expected at least the one before, {}",
                                       fall - values.begin() + 1, *(fall + 1), *fall));
}

void expect_none_negative(const H5Reader& file, const DatasetText& text, const auto& values) {
  const auto bad = std::find_if(values.begin(), values.end(), [](auto x) { return x < 0; });
  if (bad != values.end())
    file.refuse(text.path, fmt::format("value {} is {}, expected 0 or more", bad - values.begin(), *bad));
}

// The number of an attribute that is finite and not negative.
double amount(const H5Reader& file, const char* object, const char* name) {
  const auto value = file.number<double>(object, name);
  if (!(value >= 0) || std::isinf(value))
    file.refuse(fmt::format("{} attribute {}", object, name),
                fmt::format("is {}, expected a finite number, 0 or more", value));
  return value;
}

std::int64_t count(const H5Reader& file, const char* object, const char* name) {
  const auto value = file.number<std::int64_t>(object, name);
  if (value < 0)
    file.refuse(fmt::format("{} attribute {}", object, name), fmt::format("is {}, expected 0 or more", value));
  return value;
}

template <class T>
void expect_range(const H5Reader& file, const DatasetText& text, const std::vector<T>& values, std::int64_t end) {
  const auto bad =
      std::find_if(values.begin(), values.end(), [end](T x) { return x < 0 || static_cast<std::int64_t>(x) >= end; });
  if (bad != values.end())
    file.refuse(text.path, fmt::format("value {} is {}, expected 0 ... {}", bad - values.begin(), *bad, end - 1));
}

ResultsHeader read_header(const H5Reader& file) {
  ResultsHeader h;
  h.analysis = file.text(names::root, "analysis");
  h.length_unit = file.text(names::root, "length_unit");
  h.title = file.text(names::root, "title");
  h.model_file = file.text(result::model, "file");
  h.model_sha256 = file.text(result::model, "sha256");
  const auto C = file.numbers<double>(result::material, "C", {6, 6});
  std::copy(C.begin(), C.end(), h.stiffness.begin());
  h.density = amount(file, result::material, "density");
  h.light_functions = file.text(result::functions, "light_functions");
  h.light_threshold = amount(file, result::functions, "light_threshold");
  h.unknowns = count(file, result::functions, "unknowns");
  h.provenance = read_provenance(file);
  return h;
}

std::vector<double> read_field(const H5Reader& file, const DatasetText& text, std::int64_t points,
                               std::int64_t components, std::optional<std::int64_t> steps) {
  if (!file.has(text.path)) return {};
  Shape shape;
  if (steps) shape.push_back(*steps);
  shape.push_back(points);
  if (components > 1) shape.push_back(components);
  return finite(file, text, shape);
}

FieldSamples read_fields(const H5Reader& file, const result::FieldText& text, std::int64_t points,
                         std::optional<std::int64_t> steps = {}) {
  FieldSamples fields{read_field(file, text.displacement, points, 3, steps),
                      read_field(file, text.strain, points, 6, steps), read_field(file, text.stress, points, 6, steps),
                      read_field(file, text.von_mises, points, 1, steps)};
  expect_none_negative(file, text.von_mises, fields.von_mises);
  return fields;
}

// f = ω / 2π, and elastic modes ascend.
void expect_same_modes(const H5Reader& file, const EigenResult& e) {
  constexpr double rounding = 1e-12; // of a square root and a division, with room
  double before = 0;
  for (std::size_t m = 0; m < e.kind.size(); ++m) {
    if (e.kind[m] != EigenResult::Elastic) continue;
    const double omega = 2 * std::numbers::pi * e.frequencies[m], squared = std::max(e.omega_squared[m], 0.0);
    if (!(std::abs(omega * omega - squared) <= rounding * squared))
      file.refuse(result::omega_squared.path, fmt::format("value {} is {}, expected (2π f)² = {} of {}", m,
                                                          e.omega_squared[m], omega * omega, result::frequencies.path));
    if (e.frequencies[m] < before)
      file.refuse(
          result::frequencies.path,
          fmt::format("value {} is {}, expected at least {} of the elastic mode before", m, e.frequencies[m], before));
    before = e.frequencies[m];
  }
}

// Since 1.5.
void read_participation(const H5Reader& file, std::int64_t num_modes, EigenResult& e) {
  for (const auto& [text, values] : {std::pair{&result::participation, &e.participation},
                                     std::pair{&result::rotation_participation, &e.rotation_participation}})
    if (file.has(text->path)) *values = finite(file, *text, {num_modes, 3});
  if (file.has_attribute(result::eigen, "total_mass")) e.total_mass = amount(file, result::eigen, "total_mass");
  for (const auto& [name, value] :
       {std::pair{"total_inertia", &e.total_inertia}, std::pair{"centre_of_mass", &e.centre_of_mass}})
    if (file.has_attribute(result::eigen, name)) {
      const auto numbers = file.numbers<double>(result::eigen, name, {3});
      std::copy(numbers.begin(), numbers.end(), value->begin());
    }
}

EigenResult read_eigen(const H5Reader& file, std::int64_t num_functions) {
  EigenResult e;
  e.mass = file.text(result::eigen, "mass");
  e.complete_below = amount(file, result::eigen, "complete_below");
  const std::int64_t n = rows_of(file, result::frequencies);
  e.frequencies = finite(file, result::frequencies, {n});
  e.omega_squared = finite(file, result::omega_squared, {n});
  e.residuals = finite(file, result::residuals, {n});
  expect_none_negative(file, result::frequencies, e.frequencies);
  expect_none_negative(file, result::residuals, e.residuals);
  e.kind = file.enums(result::kind.path, {n}, result::kinds);
  expect_range(file, result::kind, e.kind, static_cast<std::int64_t>(result::kinds.size()));
  expect_same_modes(file, e);
  e.modes = finite(file, result::modes, {n, num_functions, 3});
  read_participation(file, n, e);
  if (file.has(result::preloads.path)) e.preload = file.strings(result::preloads.path); // since 1.5
  return e;
}

BucklingResult read_buckling(const H5Reader& file, std::int64_t num_functions) {
  BucklingResult b;
  b.complete_below = amount(file, result::buckling, "complete_below");
  b.growing = file.strings(result::growing_loads.path);
  b.constant = file.strings(result::constant_loads.path);
  const std::int64_t n = rows_of(file, result::buckling_factors);
  b.factors = finite(file, result::buckling_factors, {n});
  b.residuals = finite(file, result::buckling_residuals, {n});
  expect_none_negative(file, result::buckling_residuals, b.residuals);
  b.modes = finite(file, result::buckling_modes, {n, num_functions, 3});
  return b;
}

std::vector<std::string> read_texts(const H5Reader& file, const DatasetText& text, std::size_t expected) {
  auto values = file.strings(text.path);
  if (values.size() != expected)
    file.refuse(text.path, fmt::format("has shape ({}), expected ({})", values.size(), expected));
  return values;
}

template <class Row>
void read_vectors(const H5Reader& file, const DatasetText& text, std::vector<Row>& rows, Point3 Row::*member) {
  const auto values = in_rows<Point3>(finite(file, text, {static_cast<std::int64_t>(rows.size()), 3}));
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*member = values[i];
}

template <class Row>
void read_column(const H5Reader& file, const DatasetText& text, std::vector<Row>& rows, std::string Row::*member) {
  const auto values = read_texts(file, text, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*member = values[i];
}

template <class Row>
void read_column(const H5Reader& file, const DatasetText& text, std::vector<Row>& rows, double Row::*member) {
  const auto values = finite(file, text, {static_cast<std::int64_t>(rows.size())});
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*member = values[i];
}

std::vector<SupportResult> read_supports(const H5Reader& file) {
  std::vector<SupportResult> rows(file.strings(result::support_names.path).size());
  read_column(file, result::support_names, rows, &SupportResult::name);
  read_column(file, result::support_methods, rows, &SupportResult::method);
  read_column(file, result::support_areas, rows, &SupportResult::area);
  read_vectors(file, result::support_centroids, rows, &SupportResult::centroid);
  read_vectors(file, result::support_forces, rows, &SupportResult::force);
  read_vectors(file, result::support_moments, rows, &SupportResult::moment);
  return rows;
}

// Since 1.5.
std::vector<SpringResult> read_springs(const H5Reader& file) {
  if (!file.has(result::springs)) return {};
  std::vector<SpringResult> rows(file.strings(result::spring_names.path).size());
  read_column(file, result::spring_names, rows, &SpringResult::name);
  read_column(file, result::spring_areas, rows, &SpringResult::area);
  read_vectors(file, result::spring_centroids, rows, &SpringResult::centroid);
  read_vectors(file, result::spring_forces, rows, &SpringResult::force);
  read_vectors(file, result::spring_moments, rows, &SpringResult::moment);
  read_column(file, result::spring_energies, rows, &SpringResult::energy);
  return rows;
}

std::vector<LoadResult> read_loads(const H5Reader& file) {
  std::vector<LoadResult> rows(file.strings(result::load_names.path).size());
  read_column(file, result::load_names, rows, &LoadResult::name);
  read_column(file, result::load_kinds, rows, &LoadResult::kind);
  read_column(file, result::load_areas, rows, &LoadResult::area);
  read_vectors(file, result::load_centroids, rows, &LoadResult::centroid);
  read_vectors(file, result::load_forces, rows, &LoadResult::force);
  read_vectors(file, result::load_moments, rows, &LoadResult::moment);
  return rows;
}

std::vector<CaseResult> read_cases(const H5Reader& file, std::int64_t num_functions, const StaticResult& s) {
  std::vector<CaseResult> cases(file.strings(result::case_names.path).size());
  const auto n = static_cast<std::int64_t>(cases.size()), loads = static_cast<std::int64_t>(s.loads.size()),
             supports = static_cast<std::int64_t>(s.supports.size());
  read_column(file, result::case_names, cases, &CaseResult::name);
  read_column(file, result::case_energies, cases, &CaseResult::strain_energy);
  read_column(file, result::case_largest_displacements, cases, &CaseResult::largest_displacement);
  read_column(file, result::case_largest_stresses, cases, &CaseResult::largest_von_mises);
  const auto factors = finite(file, result::case_factors, {n, loads}),
             displacement = finite(file, result::case_displacements, {n, num_functions, 3});
  const auto forces = in_rows<Point3>(finite(file, result::case_forces, {n, supports, 3}));
  const auto part = [&](const auto& values, std::size_t c, std::int64_t width) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(c) * width;
    return std::vector(first, first + width);
  };
  for (std::size_t c = 0; c < cases.size(); ++c) {
    cases[c].factors = part(factors, c, loads);
    cases[c].displacement = part(displacement, c, 3 * num_functions);
    cases[c].support_force = part(forces, c, supports);
  }
  return cases;
}

StaticResult read_static(const H5Reader& file, std::int64_t num_functions) {
  StaticResult s;
  s.strain_energy = file.number<double>(result::statics, "strain_energy");
  s.external_work = file.number<double>(result::statics, "external_work");
  for (const auto& [name, value] :
       {std::pair{"support_work", &s.support_work}, std::pair{"gap_work", &s.gap_work},
        std::pair{"penalty_energy", &s.penalty_energy}, std::pair{"spring_energy", &s.spring_energy},
        std::pair{"initial_strain_work", &s.initial_strain_work}})
    if (file.has_attribute(result::statics, name))
      *value = file.number<double>(result::statics, name); // since 1.2, 1.5
  s.displacement = finite(file, result::displacement, {num_functions, 3});
  const std::int64_t num_points = rows_of(file, result::point_positions, 2);
  s.positions = finite(file, result::point_positions, {num_points, 3});
  s.points = read_fields(file, result::point_fields, num_points);
  s.probes.names = file.strings(result::probe_names.path);
  const auto num_probes = static_cast<std::int64_t>(s.probes.names.size());
  s.probes.positions = finite(file, result::probe_positions, {num_probes, 3});
  s.probes.fields = read_fields(file, result::probe_fields, num_probes);
  s.supports = read_supports(file);
  s.springs = read_springs(file);
  s.loads = read_loads(file);
  if (file.has(result::cases)) s.cases = read_cases(file, num_functions, s); // since 1.5
  return s;
}

HeatResult read_heat(const H5Reader& file, std::int64_t num_functions) {
  HeatResult h;
  h.temperature = finite(file, result::temperature, {num_functions});
  h.boundaries.resize(file.strings(result::heat_names.path).size());
  read_column(file, result::heat_names, h.boundaries, &HeatBoundaryResult::name);
  read_column(file, result::heat_kinds, h.boundaries, &HeatBoundaryResult::kind);
  read_column(file, result::heat_areas, h.boundaries, &HeatBoundaryResult::area);
  read_vectors(file, result::heat_centroids, h.boundaries, &HeatBoundaryResult::centroid);
  read_column(file, result::heat_temperatures, h.boundaries, &HeatBoundaryResult::temperature);
  read_column(file, result::heat_powers, h.boundaries, &HeatBoundaryResult::power);
  h.probes.names = file.strings(result::heat_probe_names.path);
  const auto probes = static_cast<std::int64_t>(h.probes.names.size());
  h.probes.positions = finite(file, result::heat_probe_positions, {probes, 3});
  h.probes.fields.temperature = finite(file, result::heat_probe_temperatures, {probes});
  h.probes.fields.heat_flux = finite(file, result::heat_probe_fluxes, {probes, 3});
  return h;
}

// Things by the list of their names; none where the group is absent.
template <class Thing>
void read_named(const H5Reader& file, const result::NamedGroup& group, std::vector<Thing>& things) {
  if (!file.has(group.path)) return;
  for (std::string& name : file.strings(group.names.path)) {
    if (std::any_of(things.begin(), things.end(), [&](const Thing& other) { return other.name == name; }))
      file.refuse(group.names.path, fmt::format("names '{}' twice, expected each name once", name));
    const std::string path = fmt::format("{}/{}", group.path, name);
    if (!file.has(path)) file.refuse(path, "is missing; expected a group");
    things.emplace_back();
    things.back().name = std::move(name);
  }
}

TimeSeries read_time_series(const H5Reader& file) {
  TimeSeries t;
  const std::int64_t n = rows_of(file, result::time);
  for (const char* group : {result::energy, result::contact_series.path})
    if (!file.has(group)) file.refuse(group, "is missing; expected a group");
  read_named(file, result::contact_series, t.contacts);
  read_named(file, result::body_series, t.bodies);
  read_named(file, result::rigid_series, t.rigid);
  read_named(file, result::support_series, t.supports);
  read_named(file, result::probe_series, t.probes);
  for_each_series(t, [&](const SeriesColumn& series, std::vector<double>& values) {
    const std::string path = fmt::format("{}/{}", result::time_series, series.path);
    if (!series.required && !file.has(path)) return;
    values = finite(file, {path.c_str(), "", "", ""}, series.components == 1 ? Shape{n} : Shape{n, series.components});
  });
  expect_ascending(file, result::time, t.time);
  return t;
}

std::vector<BodyResult> read_bodies(const H5Reader& file) {
  std::vector<BodyResult> bodies;
  read_named(file, result::body_heads, bodies);
  for (BodyResult& body : bodies) {
    const std::string path = fmt::format("{}/{}", result::body_heads.path, body.name);
    body.model_file = file.text(path.c_str(), "file");
    body.model_sha256 = file.text(path.c_str(), "sha256");
    body.law = file.text(path.c_str(), "law");
    body.mass = file.text(path.c_str(), "mass");
    body.light_functions = file.text(path.c_str(), "light_functions");
    body.light_threshold = amount(file, path.c_str(), "light_threshold");
    body.unknowns = count(file, path.c_str(), "unknowns");
    body.density = amount(file, path.c_str(), "density");
  }
  return bodies;
}

std::vector<ResultTable> read_tables(const H5Reader& file) {
  std::vector<ResultTable> tables;
  read_named(file, result::tables, tables);
  for (ResultTable& table : tables) {
    const std::string path = fmt::format("{}/{}", result::tables.path, table.name);
    const std::string columns = path + "/columns", units = path + "/units", values = path + "/values";
    table.description = file.text(path.c_str(), "content");
    table.columns = file.strings(columns.c_str());
    table.units = read_texts(file, {units.c_str(), "", "", ""}, table.columns.size());
    const DatasetText text{values.c_str(), "", "", ""};
    const std::int64_t rows = rows_of(file, text, 2);
    table.values = finite(file, text, {rows, static_cast<std::int64_t>(table.columns.size())});
  }
  return tables;
}

FieldIndex read_field_index(const H5Reader& file) {
  FieldIndex fields;
  fields.bodies_file = file.text(result::fields, "bodies_file");
  fields.times = finite(file, result::field_times, {rows_of(file, result::field_times)});
  expect_ascending(file, result::field_times, fields.times);
  fields.files = read_texts(file, result::field_files, fields.times.size());
  return fields;
}

SurfaceResult read_surface(const H5Reader& file) {
  SurfaceResult s;
  OutputMesh& o = s.output;
  const std::int64_t num_vertices = rows_of(file, result::vertices, 2),
                     num_triangles = rows_of(file, result::triangles, 2);
  o.mesh.vertices = in_rows<Point3>(finite(file, result::vertices, {num_vertices, 3}));
  o.parameters = finite(file, result::vertex_parameters, {num_vertices, 3});
  o.span = read<std::int64_t>(file, result::vertex_span, num_vertices);
  expect_none_negative(file, result::vertex_span, o.span);
  if (file.has(result::vertex_cell.path)) { // since 1.3
    o.cell = read<std::int64_t>(file, result::vertex_cell, num_vertices);
    expect_none_negative(file, result::vertex_cell, o.cell);
  }
  const auto corners = read<std::int32_t>(file, result::triangles, num_triangles, 3);
  expect_range(file, result::triangles, corners, num_vertices);
  o.mesh.triangles = in_rows<Triangle>(corners);
  o.mesh.region = read<std::int32_t>(file, result::region, num_triangles);
  o.mesh.region_names = file.strings(result::regions.path);
  expect_range(file, result::region, o.mesh.region, static_cast<std::int64_t>(o.mesh.region_names.size()));
  s.steps = finite(file, result::steps, {rows_of(file, result::steps)});
  expect_ascending(file, result::steps, s.steps);
  s.fields = read_fields(file, result::surface_fields, num_vertices, s.num_steps());
  s.fields.temperature = read_field(file, result::surface_temperature, num_vertices, 1, s.num_steps()); // since 1.5
  s.fields.heat_flux = read_field(file, result::surface_heat_flux, num_vertices, 3, s.num_steps());
  for (const auto& [text, values] : {std::pair{&result::surface_von_mises_error, &s.fields.von_mises_error},
                                     std::pair{&result::surface_safety_factor, &s.fields.safety_factor}}) {
    *values = read_field(file, *text, num_vertices, 1, s.num_steps()); // since 1.5
    expect_none_negative(file, *text, *values);
  }
  return s;
}

Results load(const H5Reader& file) {
  expect_format(file, result::format, result::format_major, result::format_version);
  Results r;
  r.header = read_header(file);
  r.header.provenance = read_provenance(file);
  const std::int64_t num_functions = rows_of(file, result::active_functions);
  r.active_functions = read<std::int64_t>(file, result::active_functions, num_functions);
  expect_none_negative(file, result::active_functions, r.active_functions);
  expect_ascending(file, result::active_functions, r.active_functions);
  const auto& analysis = r.header.analysis;
  const char* const tables = result::tables.path;
  const std::array<std::pair<const char*, const char*>, 9> parts{{{"eigen", result::eigen},
                                                                  {"static", result::statics},
                                                                  {"buckling", result::buckling},
                                                                  {"explicit", result::time_series},
                                                                  {"nonlinear", result::time_series},
                                                                  {"heat", result::heat},
                                                                  {"harmonic", tables},
                                                                  {"random", tables},
                                                                  {"transient", tables}}};
  const auto part = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return analysis == p.first; });
  if (part == parts.end())
    file.refuse("/ attribute analysis",
                fmt::format("is '{}', expected eigen, static, buckling, explicit, nonlinear, heat, harmonic, random or "
                            "transient",
                            analysis));
  if (!file.has(part->second)) file.refuse(part->second, "is missing; expected a group");
  if (file.has(result::eigen)) r.eigen = read_eigen(file, num_functions);
  if (file.has(result::statics)) r.statics = read_static(file, num_functions);
  if (file.has(result::buckling)) r.buckling = read_buckling(file, num_functions);
  if (file.has(result::heat)) r.heat = read_heat(file, num_functions);
  if (file.has(result::time_series)) r.time_series = read_time_series(file);
  if (file.has(result::surface)) r.surface = read_surface(file);
  r.bodies = read_bodies(file);
  if (file.has(result::fields)) r.fields = read_field_index(file);
  r.tables = read_tables(file);
  return r;
}

} // namespace

bool holds_results(const std::filesystem::path& path) {
  const H5Reader file(path);
  return file.has_attribute(names::root, "format") && file.text(names::root, "format") == result::format;
}

Results read_results(const std::filesystem::path& path) {
  const H5Reader file(path, H5Reader::Writer::H5Writer);
  try {
    return load(file);
  } catch (const std::bad_alloc&) {
    throw InputError(
        fmt::format("{}: holds more data than fits into the memory that is free; close other programs, use "
                    "a machine with more memory, or make a smaller file with larger spans",
                    path.string()));
  }
}

} // namespace iga::io
