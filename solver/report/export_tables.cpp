#include "solver/report/export_tables.hpp"

#include "format/io/field_files.hpp"
#include "format/model/case_envelope.hpp"
#include "format/model/span_state.hpp"
#include "format/model/time_series.hpp"
#include "solver/stress/principal.hpp"

#include <fmt/format.h>
#include <map>

namespace iga::solve {

namespace {

const std::vector<std::string> xyz{"_x", "_y", "_z"}, uvw{"_u", "_v", "_w"}, wxyz{"_w", "_x", "_y", "_z"},
    voigt{"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"};

// Units as the schema writes them, with the label in place of the word length.
class Units {
 public:
  explicit Units(std::string label) : label_(std::move(label)) {}
  std::string operator()(std::string unit) const {
    const std::string word = "length";
    const auto at = unit.find(word);
    return label_ == "unspecified" || at == std::string::npos ? unit : unit.replace(at, word.size(), label_);
  }

 private:
  std::string label_;
};

template <class Values> CsvTable& whole(CsvTable& table, const std::string& title, const Values& values) {
  return table.add(title, [&values](std::size_t row) { return fmt::format("{}", values[row]); });
}

void add_fields(CsvTable& table, const Units& units, const FieldSamples& f) {
  table.numbers("displacement", units("length"), f.displacement, xyz);
  table.numbers("strain", "1", f.strain, voigt);
  table.numbers("stress", units("force/length^2"), f.stress, voigt);
  table.numbers("von_mises", units("force/length^2"), f.von_mises);
  for (Eigen::Index k = 0; k < 3 && !f.stress.empty(); ++k) // largest first
    table.add(fmt::format("principal_stress_{} [{}]", k + 1, units("force/length^2")), [&f, k](std::size_t row) {
      return fmt::format("{}", principal_stresses(Eigen::Map<const Voigt>(&f.stress[6 * row]))[k]);
    });
  table.numbers("von_mises_error", units("force/length^2"), f.von_mises_error);
  table.numbers("safety_factor", "1", f.safety_factor);
  table.numbers("temperature", "temperature", f.temperature);
  table.numbers("heat_flux", units("power/length^2"), f.heat_flux, xyz);
}

void visit_triangles(const std::string& name, const TriangleMesh& mesh, const TableVisitor& visit) {
  CsvTable table(name, mesh.triangles.size());
  for (std::size_t c = 0; c < 3; ++c)
    table.add(fmt::format("vertex_{}", c + 1),
              [&mesh, c](std::size_t row) { return fmt::format("{}", mesh.triangles[row][c]); });
  table.add("region",
            [&mesh](std::size_t row) { return mesh.region_names[static_cast<std::size_t>(mesh.region[row])]; });
  visit(table);
}

void add_vertices(CsvTable& table, const Units& units, const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  table.add("vertex", [n](std::size_t row) { return fmt::format("{}", row % n); });
  for (std::size_t d = 0; d < 3; ++d)
    table.add(fmt::format("{} [{}]", "xyz"[d], units("length")),
              [&mesh, n, d](std::size_t row) { return fmt::format("{}", mesh.vertices[row % n][d]); });
}

// All steps one below the other.
void visit_surface(const SurfaceResult& s, const Units& units, const TableVisitor& visit) {
  const std::size_t n = s.output.mesh.vertices.size();
  CsvTable table("surface", n * s.steps.size());
  table.add("step", [&s, n](std::size_t row) { return fmt::format("{}", s.steps[row / n]); });
  add_vertices(table, units, s.output.mesh);
  add_fields(table, units, s.fields);
  visit(table);
  visit_triangles("triangles", s.output.mesh, visit);
}

// The largest values of all load cases and the names of these.
void visit_envelope(const SurfaceResult& s, const std::vector<CaseResult>& cases, const Units& units,
                    const TableVisitor& visit) {
  const SurfaceEnvelope all = surface_envelope(s);
  CsvTable table("envelope", s.output.mesh.vertices.size());
  add_vertices(table, units, s.output.mesh);
  const auto name = [&](const char* title, const std::vector<double>& number) {
    table.add(title, [&](std::size_t row) { return cases[static_cast<std::size_t>(number[row]) - 1].name; });
  };
  table.numbers("displacement", units("length"), all.displacement);
  name("displacement_case", all.displacement_case);
  table.numbers("von_mises", units("force/length^2"), all.von_mises);
  name("von_mises_case", all.von_mises_case);
  visit(table);
}

void visit_modes(const EigenResult& e, const TableVisitor& visit) {
  CsvTable table("frequencies", e.frequencies.size());
  table.add("mode", [](std::size_t row) { return fmt::format("{}", row + 1); });
  table.numbers("frequency", "1/time", e.frequencies).numbers("omega_squared", "1/time^2", e.omega_squared);
  table.add("kind", [&e](std::size_t row) -> std::string {
    const auto kind = e.kind[row];
    return kind == EigenResult::Rigid ? "rigid" : kind == EigenResult::Mechanism ? "mechanism" : "elastic";
  });
  table.numbers("residual", "1", e.residuals);
  visit(table);
}

void visit_factors(const BucklingResult& b, const TableVisitor& visit) {
  CsvTable table("factors", b.factors.size());
  table.add("mode", [](std::size_t row) { return fmt::format("{}", row + 1); });
  table.numbers("factor", "1", b.factors).numbers("residual", "1", b.residuals);
  visit(table);
}

// Sums from the first mode on, as shares of a total. (modes × 3)
std::vector<double> summed_shares(const std::vector<double>& masses, const Point3& total) {
  std::vector<double> sums = masses;
  for (std::size_t k = 3; k < sums.size(); ++k) sums[k] += sums[k - 3];
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = total[k % 3] > 0 ? sums[k] / total[k % 3] : 0;
  return sums;
}

void visit_participation(const EigenResult& e, const Units& units, const TableVisitor& visit) {
  const auto squares = [](const std::vector<double>& factors) {
    std::vector<double> all = factors;
    for (double& x : all) x *= x;
    return all;
  };
  const std::vector<double> mass = squares(e.participation), inertia = squares(e.rotation_participation);
  const std::vector<double> mass_sum = summed_shares(mass, {e.total_mass, e.total_mass, e.total_mass}),
                            inertia_sum = summed_shares(inertia, e.total_inertia);
  CsvTable table("participation", e.frequencies.size());
  table.add("mode", [](std::size_t row) { return fmt::format("{}", row + 1); });
  table.numbers("frequency", "1/time", e.frequencies);
  table.numbers("participation", "mass^(1/2)", e.participation, xyz);
  table.numbers("rotation_participation", units("mass^(1/2)*length"), e.rotation_participation, xyz);
  table.numbers("effective_mass", "mass", mass, xyz).numbers("effective_inertia", units("mass*length^2"), inertia, xyz);
  table.numbers("mass_sum", "1", mass_sum, xyz).numbers("inertia_sum", "1", inertia_sum, xyz);
  visit(table);
}

void add_vector(CsvTable& table, const std::string& title, const std::string& unit, const auto& list,
                Point3 std::remove_cvref_t<decltype(list[0])>::*member) {
  for (std::size_t d = 0; d < 3; ++d)
    table.add(fmt::format("{}{} [{}]", title, xyz[d], unit),
              [&list, member, d](std::size_t row) { return fmt::format("{}", (list[row].*member)[d]); });
}

// Supports and loads: how each acts, where, its resultant.
template <class Entry>
void visit_forces(const char* name, const std::vector<Entry>& list, const char* how, std::string Entry::*kind,
                  const Units& units, const TableVisitor& visit) {
  CsvTable table(name, list.size());
  table.add("name", [&list](std::size_t row) { return list[row].name; });
  table.add(how, [&list, kind](std::size_t row) { return list[row].*kind; });
  table.add(fmt::format("area [{}]", units("length^2")),
            [&list](std::size_t row) { return fmt::format("{}", list[row].area); });
  add_vector(table, "centroid", units("length"), list, &Entry::centroid);
  add_vector(table, "force", "force", list, &Entry::force);
  add_vector(table, "moment", units("force*length"), list, &Entry::moment);
  visit(table);
}

// One row for each load case: factors, sizes, reactions.
void visit_cases(const StaticResult& s, const Units& units, const TableVisitor& visit) {
  CsvTable table("cases", s.cases.size());
  const auto number = [&](const std::string& title, auto get) {
    table.add(title, [&s, get](std::size_t row) { return fmt::format("{}", get(s.cases[row])); });
  };
  table.add("name", [&s](std::size_t row) { return s.cases[row].name; });
  for (std::size_t k = 0; k < s.loads.size(); ++k)
    number(fmt::format("factor of {} [1]", s.loads[k].name), [k](const CaseResult& c) { return c.factors[k]; });
  number(fmt::format("strain_energy [{}]", units("force*length")), [](const CaseResult& c) { return c.strain_energy; });
  number(fmt::format("largest_displacement [{}]", units("length")),
         [](const CaseResult& c) { return c.largest_displacement; });
  number(fmt::format("largest_von_mises [{}]", units("force/length^2")),
         [](const CaseResult& c) { return c.largest_von_mises; });
  for (std::size_t k = 0; k < s.supports.size(); ++k)
    for (std::size_t d = 0; d < 3; ++d)
      number(fmt::format("reaction of {}{} [force]", s.supports[k].name, xyz[d]),
             [k, d](const CaseResult& c) { return c.support_force[k][d]; });
  visit(table);
}

void visit_heat(const HeatResult& h, const Units& units, const TableVisitor& visit) {
  CsvTable table("heat", h.boundaries.size());
  table.add("name", [&h](std::size_t row) { return h.boundaries[row].name; });
  table.add("kind", [&h](std::size_t row) { return h.boundaries[row].kind; });
  table.add(fmt::format("area [{}]", units("length^2")),
            [&h](std::size_t row) { return fmt::format("{}", h.boundaries[row].area); });
  add_vector(table, "centroid", units("length"), h.boundaries, &HeatBoundaryResult::centroid);
  table.add("temperature [temperature]",
            [&h](std::size_t row) { return fmt::format("{}", h.boundaries[row].temperature); });
  table.add("power [power]", [&h](std::size_t row) { return fmt::format("{}", h.boundaries[row].power); });
  visit(table);
  CsvTable probes("probes", h.probes.names.size());
  probes.add("name", [&h](std::size_t row) { return h.probes.names[row]; });
  probes.numbers("position", units("length"), h.probes.positions, xyz);
  add_fields(probes, units, h.probes.fields);
  visit(probes);
}

void visit_statics(const StaticResult& s, const Units& units, const TableVisitor& visit) {
  visit_forces("reactions", s.supports, "method", &SupportResult::method, units, visit);
  if (!s.springs.empty()) {
    CsvTable springs("springs", s.springs.size());
    springs.add("name", [&s](std::size_t row) { return s.springs[row].name; });
    springs.add(fmt::format("area [{}]", units("length^2")),
                [&s](std::size_t row) { return fmt::format("{}", s.springs[row].area); });
    add_vector(springs, "centroid", units("length"), s.springs, &SpringResult::centroid);
    add_vector(springs, "force", "force", s.springs, &SpringResult::force);
    add_vector(springs, "moment", units("force*length"), s.springs, &SpringResult::moment);
    springs.add(fmt::format("energy [{}]", units("force*length")),
                [&s](std::size_t row) { return fmt::format("{}", s.springs[row].energy); });
    visit(springs);
  }
  visit_forces("loads", s.loads, "kind", &LoadResult::kind, units, visit);
  if (!s.cases.empty()) visit_cases(s, units, visit);
  CsvTable probes("probes", s.probes.names.size());
  probes.add("name", [&s](std::size_t row) { return s.probes.names[row]; });
  probes.numbers("position", units("length"), s.probes.positions, xyz);
  add_fields(probes, units, s.probes.fields);
  visit(probes);
  CsvTable points("points", s.positions.size() / 3);
  points.numbers("position", units("length"), s.positions, xyz);
  add_fields(points, units, s.points);
  visit(points);
}

// Series of one source are one table, each with the time in front: "contact/plate/force" is force in contact_plate.
void visit_series(const TimeSeries& t, const Units& units, const TableVisitor& visit) {
  std::map<std::string, CsvTable> tables;
  std::vector<std::string> order;
  for_each_series(t, [&](const SeriesColumn& column, const std::vector<double>& values) {
    const auto slash = column.path.rfind('/');
    std::string name = slash == std::string::npos ? "energy" : column.path.substr(0, slash);
    if (const auto group = name.find('/'); group != std::string::npos) name[group] = '_';
    auto it = tables.find(name);
    if (it == tables.end()) {
      it = tables.emplace(name, CsvTable(name, t.time.size())).first;
      order.push_back(name);
      if (column.path != "time") it->second.numbers("time", "time", t.time);
    }
    const auto& suffixes = column.components == 1 ? std::vector<std::string>{""} : column.components == 3 ? xyz : wxyz;
    it->second.numbers(column.path.substr(slash == std::string::npos ? 0 : slash + 1), units(column.unit), values,
                       suffixes);
  });
  for (const std::string& name : order) visit(tables.at(name));
}

void visit_table(const ResultTable& from, const Units& units, const TableVisitor& visit) {
  const std::size_t columns = from.columns.size();
  CsvTable table(from.name, columns > 0 ? from.values.size() / columns : 0);
  for (std::size_t c = 0; c < columns; ++c)
    table.add(from.columns[c] + (from.units[c] == "1" ? "" : fmt::format(" [{}]", units(from.units[c]))),
              [&from, columns, c](std::size_t row) { return fmt::format("{}", from.values[columns * row + c]); });
  visit(table);
}

void visit_field_files(const std::filesystem::path& file, const Results& results, const Units& units,
                       const TableVisitor& visit) {
  const FieldIndex& index = *results.fields;
  std::vector<std::string> names;
  for (const BodyResult& body : results.bodies) names.push_back(body.name);
  const std::filesystem::path folder = file.parent_path();
  if (index.files.empty()) return;
  const std::vector<BodyMesh> meshes = io::read_body_meshes(folder / index.bodies_file, names);
  for (const BodyMesh& body : meshes) visit_triangles("triangles_" + body.name, body.surface.mesh, visit);
  for (std::size_t step = 0; step < index.files.size(); ++step)
    for (const BodyFields& fields : io::read_fields(folder / index.files[step], meshes)) {
      const auto body =
          std::find_if(meshes.begin(), meshes.end(), [&](const auto& m) { return m.name == fields.name; });
      const TriangleMesh& mesh = body->surface.mesh;
      CsvTable table(fmt::format("surface_{}_{:04d}", fields.name, step + 1), mesh.vertices.size());
      table.add(results.time_series ? "time [time]" : "step",
                [&index, step](std::size_t) { return fmt::format("{}", index.times[step]); });
      add_vertices(table, units, mesh);
      table.numbers("displacement", units("length"), fields.displacement, xyz);
      table.numbers("von_mises", units("force/length^2"), fields.von_mises).numbers("strain", "1", fields.strain);
      table.numbers("plastic_strain", "1", fields.plastic_strain);
      visit(table);
    }
}

// Position in space of every row of parameters.
std::vector<double> positions_of(const SplineGrid& grid, const std::vector<double>& parameters) {
  std::vector<double> positions;
  positions.reserve(parameters.size());
  for (std::size_t k = 0; k < parameters.size(); k += 3)
    for (const double x : grid.to_position({parameters[k], parameters[k + 1], parameters[k + 2]}))
      positions.push_back(x);
  return positions;
}

// The active span of every point.
std::vector<std::int64_t> owners(const std::vector<std::int64_t>& active, const std::vector<std::int64_t>& offsets) {
  std::vector<std::int64_t> owner;
  for (std::size_t a = 0; a < active.size(); ++a)
    owner.insert(owner.end(), static_cast<std::size_t>(offsets[a + 1] - offsets[a]), active[a]);
  return owner;
}

} // namespace

void visit_tables(const std::filesystem::path& file, const Results& results, const TableVisitor& visit) {
  const Units units(results.header.length_unit);
  if (results.eigen) visit_modes(*results.eigen, visit);
  if (results.eigen && !results.eigen->participation.empty()) visit_participation(*results.eigen, units, visit);
  if (results.buckling) visit_factors(*results.buckling, visit);
  if (results.statics) visit_statics(*results.statics, units, visit);
  if (results.heat) visit_heat(*results.heat, units, visit);
  if (results.time_series) visit_series(*results.time_series, units, visit);
  for (const ResultTable& table : results.tables) visit_table(table, units, visit);
  if (results.surface) visit_surface(*results.surface, units, visit);
  if (results.surface && results.statics && results.statics->cases.size() > 1)
    visit_envelope(*results.surface, results.statics->cases, units, visit);
  if (results.fields) visit_field_files(file, results, units, visit);
}

void visit_tables(const TrimmedModel& model, const TableVisitor& visit) {
  const Units units(model.length_unit);
  const auto owner = owners(model.cells.span, model.points.offsets);
  const auto positions = positions_of(model.grid, model.points.parameters);
  CsvTable points("points", model.points.weights.size());
  whole(points, "span", owner).numbers("position", units("length"), positions, xyz);
  points.numbers("parameter", "parameter", model.points.parameters, uvw);
  points.numbers("weight", units("length^3"), model.points.weights);
  visit(points);

  const SurfacePoints& q = model.surface.quadrature;
  const TriangleMesh& mesh = model.surface.mesh;
  const auto surface_owner = owners(model.cells.span, q.offsets);
  const auto surface_positions = positions_of(model.grid, q.parameters);
  CsvTable surface("surface_points", q.weights.size());
  whole(surface, "span", surface_owner).numbers("position", units("length"), surface_positions, xyz);
  surface.numbers("normal", "1", q.normals, xyz).numbers("weight", units("length^2"), q.weights);
  whole(surface, "triangle", q.triangle).add("region", [&](std::size_t row) {
    return mesh.region_names[static_cast<std::size_t>(mesh.region[static_cast<std::size_t>(q.triangle[row])])];
  });
  visit(surface);

  CsvTable cells("cells", model.num_cells());
  whole(cells, "span", model.cells.span).add("state", [&](std::size_t row) -> std::string {
    return model.is_interior(row) ? "interior" : "trimmed";
  });
  cells.numbers("volume_fraction", "1", model.cells.volume_fraction);
  visit(cells);

  CsvTable functions("functions", model.functions.number.size());
  whole(functions, "function", model.functions.number).numbers("mass_fraction", "1", model.functions.mass_fraction);
  visit(functions);
}

} // namespace iga::solve
