// Bitwise comparison of results, field by field, so that a failure names the field.
#pragma once

#include "format/model/results.hpp"
#include "format/model/time_series.hpp"
#include "tests/support/equal_models.hpp"

namespace iga::test {

inline void expect_equal(const ResultsHeader& a, const ResultsHeader& b) {
  EXPECT_EQ(a.analysis, b.analysis);
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.length_unit, b.length_unit);
  EXPECT_EQ(a.model_file, b.model_file);
  EXPECT_EQ(a.model_sha256, b.model_sha256);
  EXPECT_EQ(a.light_functions, b.light_functions);
  EXPECT_EQ(a.light_threshold, b.light_threshold);
  EXPECT_EQ(a.unknowns, b.unknowns);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.stiffness, b.stiffness);
  expect_equal(a.provenance, b.provenance);
}

inline void expect_equal(const FieldSamples& a, const FieldSamples& b) {
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.strain, b.strain);
  EXPECT_EQ(a.stress, b.stress);
  EXPECT_EQ(a.von_mises, b.von_mises);
  EXPECT_EQ(a.temperature, b.temperature);
  EXPECT_EQ(a.heat_flux, b.heat_flux);
  EXPECT_EQ(a.von_mises_error, b.von_mises_error);
  EXPECT_EQ(a.safety_factor, b.safety_factor);
}

inline void expect_equal(const EigenResult& a, const EigenResult& b) {
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.complete_below, b.complete_below);
  EXPECT_EQ(a.frequencies, b.frequencies);
  EXPECT_EQ(a.omega_squared, b.omega_squared);
  EXPECT_EQ(a.residuals, b.residuals);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.modes, b.modes);
  EXPECT_EQ(a.participation, b.participation);
  EXPECT_EQ(a.rotation_participation, b.rotation_participation);
  EXPECT_EQ(a.total_mass, b.total_mass);
  EXPECT_EQ(a.total_inertia, b.total_inertia);
  EXPECT_EQ(a.centre_of_mass, b.centre_of_mass);
  EXPECT_EQ(a.preload, b.preload);
}

inline void expect_equal(const BucklingResult& a, const BucklingResult& b) {
  EXPECT_EQ(a.complete_below, b.complete_below);
  EXPECT_EQ(a.growing, b.growing);
  EXPECT_EQ(a.constant, b.constant);
  EXPECT_EQ(a.factors, b.factors);
  EXPECT_EQ(a.residuals, b.residuals);
  EXPECT_EQ(a.modes, b.modes);
}

inline void expect_equal(const SupportResult& a, const SupportResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.moment, b.moment);
}

inline void expect_equal(const SpringResult& a, const SpringResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.moment, b.moment);
  EXPECT_EQ(a.energy, b.energy);
}

inline void expect_equal(const LoadResult& a, const LoadResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.moment, b.moment);
}

inline void expect_equal(const CaseResult& a, const CaseResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.factors, b.factors);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.support_force, b.support_force);
  EXPECT_EQ(a.strain_energy, b.strain_energy);
  EXPECT_EQ(a.largest_displacement, b.largest_displacement);
  EXPECT_EQ(a.largest_von_mises, b.largest_von_mises);
}

inline void expect_equal(const HeatResult& a, const HeatResult& b) {
  EXPECT_EQ(a.temperature, b.temperature);
  ASSERT_EQ(a.boundaries.size(), b.boundaries.size());
  for (std::size_t i = 0; i < a.boundaries.size(); ++i) {
    EXPECT_EQ(a.boundaries[i].name, b.boundaries[i].name);
    EXPECT_EQ(a.boundaries[i].kind, b.boundaries[i].kind);
    EXPECT_EQ(a.boundaries[i].area, b.boundaries[i].area);
    EXPECT_EQ(a.boundaries[i].centroid, b.boundaries[i].centroid);
    EXPECT_EQ(a.boundaries[i].temperature, b.boundaries[i].temperature);
    EXPECT_EQ(a.boundaries[i].power, b.boundaries[i].power);
  }
  EXPECT_EQ(a.probes.names, b.probes.names);
  EXPECT_EQ(a.probes.positions, b.probes.positions);
  expect_equal(a.probes.fields, b.probes.fields);
}

inline void expect_equal(const StaticResult& a, const StaticResult& b) {
  EXPECT_EQ(a.strain_energy, b.strain_energy);
  EXPECT_EQ(a.initial_strain_work, b.initial_strain_work);
  ASSERT_EQ(a.cases.size(), b.cases.size());
  for (std::size_t i = 0; i < a.cases.size(); ++i) expect_equal(a.cases[i], b.cases[i]);
  EXPECT_EQ(a.external_work, b.external_work);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.positions, b.positions);
  expect_equal(a.points, b.points);
  EXPECT_EQ(a.probes.names, b.probes.names);
  EXPECT_EQ(a.probes.positions, b.probes.positions);
  expect_equal(a.probes.fields, b.probes.fields);
  ASSERT_EQ(a.supports.size(), b.supports.size());
  for (std::size_t i = 0; i < a.supports.size(); ++i) expect_equal(a.supports[i], b.supports[i]);
  EXPECT_EQ(a.spring_energy, b.spring_energy);
  ASSERT_EQ(a.springs.size(), b.springs.size());
  for (std::size_t i = 0; i < a.springs.size(); ++i) expect_equal(a.springs[i], b.springs[i]);
  ASSERT_EQ(a.loads.size(), b.loads.size());
  for (std::size_t i = 0; i < a.loads.size(); ++i) expect_equal(a.loads[i], b.loads[i]);
}

inline void expect_equal(const TimeSeries& a, const TimeSeries& b) {
  const auto all = [](const TimeSeries& t) {
    std::vector<std::pair<std::string, std::vector<double>>> series;
    for_each_series(t,
                    [&](const SeriesColumn& column, const auto& values) { series.emplace_back(column.path, values); });
    return series;
  };
  const auto left = all(a), right = all(b);
  ASSERT_EQ(left.size(), right.size());
  for (std::size_t i = 0; i < left.size(); ++i) EXPECT_EQ(left[i], right[i]) << left[i].first;
}

inline void expect_equal(const BodyResult& a, const BodyResult& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.model_file, b.model_file);
  EXPECT_EQ(a.model_sha256, b.model_sha256);
  EXPECT_EQ(a.law, b.law);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.light_functions, b.light_functions);
  EXPECT_EQ(a.light_threshold, b.light_threshold);
  EXPECT_EQ(a.unknowns, b.unknowns);
  EXPECT_EQ(a.density, b.density);
}

inline void expect_equal(const FieldIndex& a, const FieldIndex& b) {
  EXPECT_EQ(a.bodies_file, b.bodies_file);
  EXPECT_EQ(a.times, b.times);
  EXPECT_EQ(a.files, b.files);
}

inline void expect_equal(const SurfaceResult& a, const SurfaceResult& b) {
  EXPECT_EQ(a.output.mesh.vertices, b.output.mesh.vertices);
  EXPECT_EQ(a.output.mesh.triangles, b.output.mesh.triangles);
  EXPECT_EQ(a.output.mesh.region, b.output.mesh.region);
  EXPECT_EQ(a.output.mesh.region_names, b.output.mesh.region_names);
  EXPECT_EQ(a.output.parameters, b.output.parameters);
  EXPECT_EQ(a.output.span, b.output.span);
  EXPECT_EQ(a.output.cell, b.output.cell);
  EXPECT_EQ(a.steps, b.steps);
  expect_equal(a.fields, b.fields);
}

inline void expect_equal(const ResultTable& a, const ResultTable& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.description, b.description);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.units, b.units);
  EXPECT_EQ(a.values, b.values);
}

inline void expect_equal(const Results& a, const Results& b) {
  expect_equal(a.header, b.header);
  EXPECT_EQ(a.active_functions, b.active_functions);
  const auto parts = [](const auto& x, const auto& y) {
    ASSERT_EQ(x.has_value(), y.has_value());
    if (x) expect_equal(*x, *y);
  };
  parts(a.eigen, b.eigen);
  parts(a.statics, b.statics);
  parts(a.heat, b.heat);
  parts(a.time_series, b.time_series);
  parts(a.surface, b.surface);
  parts(a.fields, b.fields);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) expect_equal(a.bodies[i], b.bodies[i]);
  ASSERT_EQ(a.tables.size(), b.tables.size());
  for (std::size_t i = 0; i < a.tables.size(); ++i) expect_equal(a.tables[i], b.tables[i]);
}

} // namespace iga::test
