#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/io/output_ending.hpp"
#include "format/io/provenance_io.hpp"
#include "format/io/result_names.hpp"
#include "format/io/results_io.hpp"

#include "format/model/errors.hpp"
#include "format/model/time_series.hpp"

#include <fmt/format.h>

namespace iga::io {

namespace {

namespace result = result_names;

void write_header(H5Writer& file, const Results& r) {
  const ResultsHeader& h = r.header;
  file.attribute(names::root, "format", std::string(result::format));
  file.attribute(names::root, "format_version", std::string(result::format_version));
  file.attribute(names::root, "analysis", h.analysis);
  file.attribute(names::root, "length_unit", h.length_unit);
  file.attribute(names::root, "title", h.title);
  file.group(result::model, "the interchange file that was analysed");
  file.attribute(result::model, "file", h.model_file);
  file.attribute(result::model, "sha256", h.model_sha256);
  file.group(result::material, "stress = C strain in the order xx yy zz xy yz zx, engineering shear strains");
  file.attribute<double>(result::material, "C", {6, 6}, h.stiffness);
  file.attribute(result::material, "density", h.density);
  file.group(result::functions, "the functions that the coefficients belong to");
  file.attribute(result::functions, "light_functions", h.light_functions);
  file.attribute(result::functions, "light_threshold", h.light_threshold);
  file.attribute(result::functions, "unknowns", h.unknowns);
  write(file, result::active_functions, r.active_functions);
}

// (points × components), or (steps × points × components) where steps are given.
void write_field(H5Writer& file, const DatasetText& text, const std::vector<double>& values, std::int64_t points,
                 std::int64_t components, std::optional<std::int64_t> steps) {
  if (values.empty() && points > 0) return;
  Shape shape;
  if (steps) shape.push_back(*steps);
  shape.push_back(points);
  if (components > 1) shape.push_back(components);
  file.dataset(text, shape, std::span<const double>(values));
}

void write_fields(H5Writer& file, const result::FieldText& text, const FieldSamples& f, std::int64_t points,
                  std::optional<std::int64_t> steps = {}) {
  write_field(file, text.displacement, f.displacement, points, 3, steps);
  write_field(file, text.strain, f.strain, points, 6, steps);
  write_field(file, text.stress, f.stress, points, 6, steps);
  write_field(file, text.von_mises, f.von_mises, points, 1, steps);
}

void write_eigen(H5Writer& file, const EigenResult& e, std::int64_t num_functions) {
  file.group(result::eigen, "natural modes");
  file.attribute(result::eigen, "mass", e.mass);
  file.attribute(result::eigen, "complete_below", e.complete_below);
  const auto n = static_cast<std::int64_t>(e.frequencies.size());
  write(file, result::frequencies, e.frequencies);
  write(file, result::omega_squared, e.omega_squared);
  write(file, result::residuals, e.residuals);
  file.enums(result::kind, {n}, e.kind, result::kinds);
  file.dataset(result::modes, {n, num_functions, 3}, std::span<const double>(e.modes));
  if (!e.preload.empty()) file.strings(result::preloads, e.preload);
  if (e.participation.empty()) return;
  file.attribute(result::eigen, "total_mass", e.total_mass);
  file.attribute<double>(result::eigen, "total_inertia", {3}, e.total_inertia);
  file.attribute<double>(result::eigen, "centre_of_mass", {3}, e.centre_of_mass);
  file.dataset(result::participation, {n, 3}, std::span<const double>(e.participation));
  file.dataset(result::rotation_participation, {n, 3}, std::span<const double>(e.rotation_participation));
}

void write_buckling(H5Writer& file, const BucklingResult& b, std::int64_t num_functions) {
  file.group(result::buckling, "linear buckling");
  file.attribute(result::buckling, "complete_below", b.complete_below);
  file.strings(result::growing_loads, b.growing);
  file.strings(result::constant_loads, b.constant);
  write(file, result::buckling_factors, b.factors);
  write(file, result::buckling_residuals, b.residuals);
  // Of several bodies the shapes lie in the field files.
  const auto n = static_cast<std::int64_t>(b.factors.size());
  file.dataset(result::buckling_modes, {n, num_functions, 3}, std::span<const double>(b.modes));
}

// What the rows of a list of supports or loads have in common.
template <class Row, class Get> auto column(const std::vector<Row>& rows, Get get) {
  std::vector<std::decay_t<decltype(get(rows.front()))>> values;
  for (const Row& row : rows) values.push_back(get(row));
  return values;
}

template <class Row>
void write_vectors(H5Writer& file, const DatasetText& text, const std::vector<Row>& rows, Point3 Row::*member) {
  const auto values = column(rows, [member](const Row& row) { return row.*member; });
  file.dataset(text, {static_cast<std::int64_t>(rows.size()), 3}, flat(values));
}

void write_supports(H5Writer& file, const std::vector<SupportResult>& supports) {
  file.group(result::supports, "what holds the part");
  file.strings(result::support_names, column(supports, [](const auto& s) { return s.name; }));
  file.strings(result::support_methods, column(supports, [](const auto& s) { return s.method; }));
  write(file, result::support_areas, column(supports, [](const auto& s) { return s.area; }));
  write_vectors(file, result::support_centroids, supports, &SupportResult::centroid);
  write_vectors(file, result::support_forces, supports, &SupportResult::force);
  write_vectors(file, result::support_moments, supports, &SupportResult::moment);
}

void write_springs(H5Writer& file, const std::vector<SpringResult>& springs) {
  if (springs.empty()) return;
  file.group(result::springs, "springs between the part and the ground");
  file.strings(result::spring_names, column(springs, [](const auto& s) { return s.name; }));
  write(file, result::spring_areas, column(springs, [](const auto& s) { return s.area; }));
  write_vectors(file, result::spring_centroids, springs, &SpringResult::centroid);
  write_vectors(file, result::spring_forces, springs, &SpringResult::force);
  write_vectors(file, result::spring_moments, springs, &SpringResult::moment);
  write(file, result::spring_energies, column(springs, [](const auto& s) { return s.energy; }));
}

void write_loads(H5Writer& file, const std::vector<LoadResult>& loads) {
  file.group(result::loads, "what acts on the part");
  file.strings(result::load_names, column(loads, [](const auto& l) { return l.name; }));
  file.strings(result::load_kinds, column(loads, [](const auto& l) { return l.kind; }));
  write(file, result::load_areas, column(loads, [](const auto& l) { return l.area; }));
  write_vectors(file, result::load_centroids, loads, &LoadResult::centroid);
  write_vectors(file, result::load_forces, loads, &LoadResult::force);
  write_vectors(file, result::load_moments, loads, &LoadResult::moment);
}

void write_cases(H5Writer& file, const StaticResult& s) {
  file.group(result::cases, "load cases; what else /static holds is that of the first one");
  const auto n = static_cast<std::int64_t>(s.cases.size()), loads = static_cast<std::int64_t>(s.loads.size()),
             supports = static_cast<std::int64_t>(s.supports.size());
  file.strings(result::case_names, column(s.cases, [](const auto& c) { return c.name; }));
  std::vector<double> factors, displacement, forces;
  for (const CaseResult& c : s.cases) {
    factors.insert(factors.end(), c.factors.begin(), c.factors.end());
    displacement.insert(displacement.end(), c.displacement.begin(), c.displacement.end());
    for (const Point3& f : c.support_force) forces.insert(forces.end(), f.begin(), f.end());
  }
  file.dataset(result::case_factors, {n, loads}, std::span<const double>(factors));
  file.dataset(result::case_displacements, {n, static_cast<std::int64_t>(displacement.size()) / (3 * n), 3},
               std::span<const double>(displacement));
  file.dataset(result::case_forces, {n, supports, 3}, std::span<const double>(forces));
  write(file, result::case_energies, column(s.cases, [](const auto& c) { return c.strain_energy; }));
  write(file, result::case_largest_displacements,
        column(s.cases, [](const auto& c) { return c.largest_displacement; }));
  write(file, result::case_largest_stresses, column(s.cases, [](const auto& c) { return c.largest_von_mises; }));
}

void write_static(H5Writer& file, const StaticResult& s) {
  file.group(result::statics, "static equilibrium");
  file.attribute(result::statics, "strain_energy", s.strain_energy);
  file.attribute(result::statics, "external_work", s.external_work);
  file.attribute(result::statics, "support_work", s.support_work);
  file.attribute(result::statics, "gap_work", s.gap_work);
  file.attribute(result::statics, "penalty_energy", s.penalty_energy);
  file.attribute(result::statics, "spring_energy", s.spring_energy);
  // It says, too, that there was such a strain: readers cannot make stresses from the displacement alone.
  if (s.initial_strain_work != 0) file.attribute(result::statics, "initial_strain_work", s.initial_strain_work);
  write(file, result::displacement, s.displacement, 3);
  file.group(result::points, "fields at the model's quadrature points, in their order");
  write(file, result::point_positions, s.positions, 3);
  write_fields(file, result::point_fields, s.points, static_cast<std::int64_t>(s.positions.size() / 3));
  file.group(result::probes, "fields at points that were asked for");
  file.strings(result::probe_names, s.probes.names);
  write(file, result::probe_positions, s.probes.positions, 3);
  write_fields(file, result::probe_fields, s.probes.fields, static_cast<std::int64_t>(s.probes.names.size()));
  write_supports(file, s.supports);
  write_springs(file, s.springs);
  write_loads(file, s.loads);
  if (!s.cases.empty()) write_cases(file, s);
}

void write_heat(H5Writer& file, const HeatResult& h) {
  file.group(result::heat, "steady conduction of heat");
  write(file, result::temperature, h.temperature);
  file.group(result::heat_boundaries, "what heat goes through");
  file.strings(result::heat_names, column(h.boundaries, [](const auto& b) { return b.name; }));
  file.strings(result::heat_kinds, column(h.boundaries, [](const auto& b) { return b.kind; }));
  write(file, result::heat_areas, column(h.boundaries, [](const auto& b) { return b.area; }));
  write_vectors(file, result::heat_centroids, h.boundaries, &HeatBoundaryResult::centroid);
  write(file, result::heat_temperatures, column(h.boundaries, [](const auto& b) { return b.temperature; }));
  write(file, result::heat_powers, column(h.boundaries, [](const auto& b) { return b.power; }));
  file.group(result::heat_probes, "points that were asked for");
  file.strings(result::heat_probe_names, h.probes.names);
  write(file, result::heat_probe_positions, h.probes.positions, 3);
  write(file, result::heat_probe_temperatures, h.probes.fields.temperature);
  write(file, result::heat_probe_fluxes, h.probes.fields.heat_flux, 3);
}

// A group of groups, one per named thing, and the list of their names.
template <class Thing>
void write_named(H5Writer& file, const result::NamedGroup& group, const std::vector<Thing>& things) {
  file.group(group.path, group.description);
  file.strings(group.names, column(things, [](const auto& thing) { return thing.name; }));
  for (const Thing& thing : things) file.group(fmt::format("{}/{}", group.path, thing.name).c_str(), group.one);
}

void write_time_series(H5Writer& file, const TimeSeries& t) {
  file.group(result::time_series, "what changes with time");
  file.group(result::energy, "energies of the whole system");
  write_named(file, result::contact_series, t.contacts);
  if (!t.bodies.empty()) write_named(file, result::body_series, t.bodies);
  if (!t.rigid.empty()) write_named(file, result::rigid_series, t.rigid);
  if (!t.supports.empty()) write_named(file, result::support_series, t.supports);
  if (!t.probes.empty()) write_named(file, result::probe_series, t.probes);
  for_each_series(t, [&](const SeriesColumn& series, const std::vector<double>& values) {
    if (values.empty() && !t.time.empty()) return;
    const std::string path = fmt::format("{}/{}", result::time_series, series.path);
    write(file, {path.c_str(), series.unit, series.order, series.description}, values, series.components);
  });
}

void write_bodies(H5Writer& file, const std::vector<BodyResult>& bodies) {
  write_named(file, result::body_heads, bodies);
  for (const BodyResult& body : bodies) {
    const std::string path = fmt::format("{}/{}", result::body_heads.path, body.name);
    file.attribute(path.c_str(), "file", body.model_file);
    file.attribute(path.c_str(), "sha256", body.model_sha256);
    file.attribute(path.c_str(), "law", body.law);
    file.attribute(path.c_str(), "mass", body.mass);
    file.attribute(path.c_str(), "light_functions", body.light_functions);
    file.attribute(path.c_str(), "light_threshold", body.light_threshold);
    file.attribute(path.c_str(), "unknowns", body.unknowns);
    file.attribute(path.c_str(), "density", body.density);
  }
}

void write_field_index(H5Writer& file, const FieldIndex& fields) {
  file.group(result::fields, "files beside this one that hold the fields");
  file.attribute(result::fields, "bodies_file", fields.bodies_file);
  write(file, result::field_times, fields.times);
  file.strings(result::field_files, fields.files);
}

void write_tables(H5Writer& file, const std::vector<ResultTable>& tables) {
  write_named(file, result::tables, tables);
  for (const ResultTable& table : tables) {
    const std::string path = fmt::format("{}/{}", result::tables.path, table.name);
    file.attribute(path.c_str(), "content", table.description);
    const auto put = [&](const char* name, const char* order, const char* text, const auto& write_it) {
      const std::string at = fmt::format("{}/{}", path, name);
      write_it(DatasetText{at.c_str(), "1", order, text});
    };
    put("columns", "(column)", "names of the columns",
        [&](const DatasetText& text) { file.strings(text, table.columns); });
    put("units", "(column)", "units of the columns", [&](const DatasetText& text) { file.strings(text, table.units); });
    put("values", "(row; column)", "numbers, each column in its unit", [&](const DatasetText& text) {
      const auto columns = static_cast<std::int64_t>(table.columns.size()),
                 entries = static_cast<std::int64_t>(table.values.size());
      file.dataset(text, {columns > 0 ? entries / columns : 0, columns}, std::span<const double>(table.values));
    });
  }
}

void write_surface(H5Writer& file, const SurfaceResult& s) {
  const OutputMesh& o = s.output;
  const auto num_vertices = static_cast<std::int64_t>(o.mesh.vertices.size());
  file.group(result::surface, "fields on the embedded surface, step by step");
  file.dataset(result::vertices, {num_vertices, 3}, flat(o.mesh.vertices));
  write(file, result::vertex_parameters, o.parameters, 3);
  write(file, result::vertex_span, o.span);
  if (!o.cell.empty()) write(file, result::vertex_cell, o.cell);
  file.dataset(result::triangles, {static_cast<std::int64_t>(o.mesh.triangles.size()), 3}, flat(o.mesh.triangles));
  write(file, result::region, o.mesh.region);
  file.strings(result::regions, o.mesh.region_names);
  write(file, result::steps, s.steps);
  write_fields(file, result::surface_fields, s.fields, num_vertices, s.num_steps());
  write_field(file, result::surface_temperature, s.fields.temperature, num_vertices, 1, s.num_steps());
  write_field(file, result::surface_heat_flux, s.fields.heat_flux, num_vertices, 3, s.num_steps());
  write_field(file, result::surface_von_mises_error, s.fields.von_mises_error, num_vertices, 1, s.num_steps());
  write_field(file, result::surface_safety_factor, s.fields.safety_factor, num_vertices, 1, s.num_steps());
}

} // namespace

void check_results_target(const std::filesystem::path& path, bool force) {
  refuse_foreign_ending(path);
  std::error_code error;
  if (!force && std::filesystem::exists(path, error))
    throw InputError(fmt::format("{}: exists; choose another name or add --force to replace it", path.string()));
  const ReplacementFile trial(path); // vanishes again
}

void write_results(const std::filesystem::path& path, const Results& results, bool force) {
  check_results_target(path, force);
  H5Writer file(path);
  write_header(file, results);
  if (results.eigen) write_eigen(file, *results.eigen, static_cast<std::int64_t>(results.active_functions.size()));
  if (results.statics) write_static(file, *results.statics);
  if (results.heat) write_heat(file, *results.heat);
  if (results.buckling)
    write_buckling(file, *results.buckling, static_cast<std::int64_t>(results.active_functions.size()));
  if (results.time_series) write_time_series(file, *results.time_series);
  if (results.surface) write_surface(file, *results.surface);
  if (!results.bodies.empty()) write_bodies(file, results.bodies);
  if (results.fields) write_field_index(file, *results.fields);
  if (!results.tables.empty()) write_tables(file, results.tables);
  write_provenance(file, results.header.provenance);
  file.commit();
}

} // namespace iga::io
