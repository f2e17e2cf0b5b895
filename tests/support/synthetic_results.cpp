#include "tests/support/synthetic_results.hpp"

#include "format/model/time_series.hpp"
#include "format/model/vec3.hpp"

#include <cmath>
#include <numbers>

namespace iga::test {

namespace {

void append(std::vector<double>& values, const Point3& x) {
  values.insert(values.end(), x.begin(), x.end());
}

// Numbers that no two entries share, so that a mix-up is seen.
std::vector<double> counted(std::size_t count, double first) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = first + 1e-3 * static_cast<double>(i);
  return values;
}

Point3 greville_position(const TrimmedModel& model, std::int64_t function) {
  return model.grid.control_point(model.grid.function_index(function));
}

void append_coefficients(std::vector<double>& values, const TrimmedModel& model, int step) {
  const LinearField field(step);
  for (const std::int64_t function : model.functions.number)
    append(values, field.at(greville_position(model, function)));
}

Results with_header(const TrimmedModel& model, const char* analysis) {
  Results r;
  ResultsHeader& h = r.header;
  h.analysis = analysis;
  h.title = model.title;
  h.length_unit = model.length_unit;
  h.model_file = "box.h5";
  h.model_sha256 = std::string(64, 'd');
  h.light_functions = "linear";
  h.light_threshold = 0.05;
  h.unknowns = static_cast<std::int64_t>(3 * model.functions.number.size());
  h.density = 7.8e-6;
  const auto C = counted(36, 200);
  std::copy(C.begin(), C.end(), h.stiffness.begin());
  h.provenance = model.provenance;
  h.provenance.producer = "igasolve";
  r.active_functions = model.functions.number;
  return r;
}

EigenResult make_eigen(const TrimmedModel& model) {
  EigenResult e;
  e.complete_below = 7.25;
  e.frequencies = {0, 0, 0, 0, 0, 0, 0, 3.5, 7};
  e.kind = {0, 0, 0, 0, 0, 0, 2, 1, 1};
  e.omega_squared = counted(9, -1e-3);
  for (const std::size_t elastic : {7, 8})
    e.omega_squared[elastic] = std::pow(2 * std::numbers::pi * e.frequencies[elastic], 2);
  e.residuals = counted(9, 1e-9);
  for (int mode = 0; mode < 9; ++mode) append_coefficients(e.modes, model, mode);
  e.participation = counted(27, 0.5);
  e.rotation_participation = counted(27, -0.25);
  e.centre_of_mass = {1, 2, -3};
  e.total_mass = 4.5;
  e.total_inertia = {6, 7, 8};
  return e;
}

BucklingResult make_buckling(const TrimmedModel& model) {
  BucklingResult b;
  b.complete_below = 4.5;
  b.growing = {"wind", "bolt"};
  b.constant = {"weight"};
  b.factors = {2.5, 4, -3};
  b.residuals = counted(3, 1e-9);
  for (int mode = 0; mode < 3; ++mode) append_coefficients(b.modes, model, mode);
  return b;
}

StaticResult make_static(const TrimmedModel& model) {
  StaticResult s;
  s.strain_energy = 12.5;
  s.external_work = 12.625;
  append_coefficients(s.displacement, model, 0);
  const std::size_t n = model.points.weights.size();
  const LinearField field(0);
  for (std::size_t q = 0; q < n; ++q) {
    const double* u = &model.points.parameters[3 * q];
    const Point3 x = model.grid.to_position({u[0], u[1], u[2]});
    append(s.positions, x);
    append(s.points.displacement, field.at(x));
  }
  s.points.strain = counted(6 * n, 1);
  s.points.stress = counted(6 * n, 2);
  s.points.von_mises = counted(n, 3);
  s.probes = {{"tip"}, {1, 2, 3}, {{4, 5, 6}, counted(6, 7), counted(6, 8), {9}}};
  s.supports = {{"Wand", "nitsche", 2.5, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}},
                {"symmetry", "lagrange", 3.5, {11, 12, 13}, {14, 15, 16}, {17, 18, 19}}};
  s.spring_energy = 0.25;
  s.springs = {{"mount", 1.5, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 0.25}};
  s.loads = {{"weight", "body force", 0, {1, 1, 1}, {0, 0, -2}, {0, 0, 0}},
             {"wind", "pressure", 4, {2, 2, 2}, {3, 0, 0}, {0, 1, 0}},
             {"nail", "point", 0, {5, 5, 5}, {0, 6, 0}, {0, 0, 0}}};
  return s;
}

TimeSeries make_time_series() {
  TimeSeries t;
  t.time = {0, 0.5, 1};
  t.contacts.resize(2);
  t.contacts[0].name = "hammer";
  t.contacts[1].name = "anvil";
  t.bodies.resize(1);
  t.bodies[0].name = "Block";
  t.rigid.resize(1);
  t.rigid[0].name = "a tool";
  t.supports = {{"foot", {}}};
  t.probes = {{"tip", {}}};
  double first = 0;
  for_each_series(t, [&first](const SeriesColumn& column, std::vector<double>& values) {
    if (values.empty()) values = counted(3 * static_cast<std::size_t>(column.components), ++first);
  });
  return t;
}

} // namespace

LinearField::LinearField(int step) {
  const double s = 1 + step;
  G = {{{1e-3 * s, 2e-4, 0}, {0, -3e-4 * s, 1e-4}, {5e-4, 0, 2e-4}}};
  c = {1e-3, 0, -2e-3 * s};
}

Point3 LinearField::at(const Point3& x) const {
  return plus(c, {dot(G[0], x), dot(G[1], x), dot(G[2], x)});
}

SurfaceResult make_surface_result(const TrimmedModel& model, int num_steps) {
  SurfaceResult s;
  s.output = {model.surface.mesh, model.surface.vertex_parameters, {}, model.surface.vertex_cell};
  for (const std::int64_t cell : model.surface.vertex_cell)
    s.output.span.push_back(model.cells.span[static_cast<std::size_t>(cell)]);
  for (int step = 0; step < num_steps; ++step) {
    const LinearField field(step);
    s.steps.push_back(step + 1);
    for (std::size_t v = 0; v < model.surface.mesh.vertices.size(); ++v) {
      append(s.fields.displacement, field.at(model.surface.mesh.vertices[v]));
      s.fields.von_mises.push_back(100 * (step + 1) + static_cast<double>(v));
    }
  }
  return s;
}

Results make_eigen_results(const TrimmedModel& model) {
  Results r = with_header(model, "eigen");
  r.eigen = make_eigen(model);
  r.surface = make_surface_result(model, 9);
  return r;
}

Results make_static_results(const TrimmedModel& model) {
  Results r = with_header(model, "static");
  r.statics = make_static(model);
  r.surface = make_surface_result(model, 1);
  const std::size_t n = model.surface.mesh.vertices.size();
  r.surface->fields.stress = counted(6 * n, 10);
  r.surface->fields.strain = counted(6 * n, 20);
  return r;
}

Results make_buckling_results(const TrimmedModel& model) {
  Results r = with_header(model, "buckling");
  r.buckling = make_buckling(model);
  r.surface = make_surface_result(model, 3);
  return r;
}

Results make_full_results(const TrimmedModel& model) {
  Results r = make_eigen_results(model);
  r.eigen->preload = {"bolt", "spin"};
  r.buckling = make_buckling(model);
  r.statics = make_static(model);
  r.statics->initial_strain_work = -0.125;
  for (const double share : {1.0, 2.0}) {
    CaseResult one{share == 1 ? "hot" : "cold",
                   counted(3, 30 * share),
                   {},
                   {{share, 2, 3}, {4, share, 6}},
                   7 * share,
                   8 * share,
                   9 * share};
    one.displacement = counted(3 * model.functions.number.size(), 40 * share);
    r.statics->cases.push_back(one);
  }
  r.heat = HeatResult{counted(model.functions.number.size(), 300),
                      {{"oven", "convection", 2.5, {1, 2, 3}, 80, 5}, {"tap", "temperature", 1.5, {4, 5, 6}, 20, -5}},
                      {{"core"}, {1, 2, 3}, {{}, {}, {}, {}, {55}, {7, 8, 9}}}};
  r.time_series = make_time_series();
  r.bodies = {{"Block", "box.h5", std::string(64, 'e'), "neo-hookean", "lumped", "linear", 0.01, 300, 7.8e-6},
              {"other", "box.h5", std::string(64, 'f'), "j2", "two-pass", "none", 0, 30, 7.8e-9}};
  r.fields =
      FieldIndex{"full_fields/full_bodies.h5", {0, 0.5}, {"full_fields/full_0001.h5", "full_fields/full_0002.h5"}};
  r.tables = {{"probe tip", "amplitudes", {"frequency", "displacement_x"}, {"1/time", "length"}, {1, 2, 3, 4, 5, 6}},
              {"rms", "root mean squares", {"stress_xx"}, {"force/length^2"}, {7}}};
  const std::size_t n = model.surface.mesh.vertices.size();
  r.surface->fields.stress = counted(9 * 6 * n, 10);
  r.surface->fields.strain = counted(9 * 6 * n, 20);
  r.surface->fields.temperature = counted(9 * n, 50);
  r.surface->fields.heat_flux = counted(9 * 3 * n, 60);
  r.surface->fields.von_mises_error = counted(9 * n, 70);
  r.surface->fields.safety_factor = counted(9 * n, 80);
  return r;
}

} // namespace iga::test
