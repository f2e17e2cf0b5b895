// Bitwise comparison of models, field by field, so that a failure names the field.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <gtest/gtest.h>

namespace iga::test {

inline void expect_equal(const Provenance& a, const Provenance& b) {
  EXPECT_EQ(a.producer, b.producer);
  EXPECT_EQ(a.version, b.version);
  EXPECT_EQ(a.command_line, b.command_line);
  EXPECT_EQ(a.settings_sha256, b.settings_sha256);
  EXPECT_EQ(a.created, b.created);
  EXPECT_EQ(a.timings, b.timings);
  EXPECT_EQ(a.findings, b.findings);
  EXPECT_EQ(a.warnings, b.warnings);
  ASSERT_EQ(a.inputs.size(), b.inputs.size());
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    EXPECT_EQ(a.inputs[i].name, b.inputs[i].name);
    EXPECT_EQ(a.inputs[i].sha256, b.inputs[i].sha256);
  }
}

inline void expect_equal(const QuadratureInfo& a, const QuadratureInfo& b) {
  EXPECT_EQ(a.interior_rule, b.interior_rule);
  EXPECT_EQ(a.trimmed_rule, b.trimmed_rule);
  EXPECT_EQ(a.surface_rule, b.surface_rule);
  EXPECT_EQ(a.moment_degree, b.moment_degree);
  EXPECT_EQ(a.tolerance, b.tolerance);
  EXPECT_EQ(a.max_residual, b.max_residual);
  EXPECT_EQ(a.sliver_tolerance, b.sliver_tolerance);
  EXPECT_EQ(a.min_fraction, b.min_fraction);
  EXPECT_EQ(a.part_volume, b.part_volume);
  EXPECT_EQ(a.snapped_volume, b.snapped_volume);
  EXPECT_EQ(a.dropped_volume, b.dropped_volume);
  EXPECT_EQ(a.snapped_spans, b.snapped_spans);
  EXPECT_EQ(a.dropped_spans, b.dropped_spans);
}

inline void expect_equal(const TrimmedModel& a, const TrimmedModel& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.length_unit, b.length_unit);
  EXPECT_EQ(a.grid.A(), b.grid.A());
  EXPECT_EQ(a.grid.B(), b.grid.B());
  EXPECT_EQ(a.grid.spans(), b.grid.spans());
  EXPECT_EQ(a.grid.degree(), b.grid.degree());
  EXPECT_EQ(a.grid.rotation(), b.grid.rotation());
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.cells.span, b.cells.span);
  EXPECT_EQ(a.cells.state, b.cells.state);
  EXPECT_EQ(a.cells.volume_fraction, b.cells.volume_fraction);
  EXPECT_EQ(a.cells.functions, b.cells.functions);
  EXPECT_EQ(a.links.cells, b.links.cells);
  EXPECT_EQ(a.points.offsets, b.points.offsets);
  EXPECT_EQ(a.points.parameters, b.points.parameters);
  EXPECT_EQ(a.points.weights, b.points.weights);
  EXPECT_EQ(a.points.residual, b.points.residual);
  expect_equal(a.quadrature, b.quadrature);
  EXPECT_EQ(a.functions.number, b.functions.number);
  EXPECT_EQ(a.unknowns.offsets, b.unknowns.offsets);
  EXPECT_EQ(a.unknowns.terms, b.unknowns.terms);
  EXPECT_EQ(a.unknowns.weights, b.unknowns.weights);
  EXPECT_EQ(a.unknowns.function, b.unknowns.function);
  EXPECT_EQ(a.unknowns.parameters, b.unknowns.parameters);
  EXPECT_EQ(a.unknowns.mass_fraction, b.unknowns.mass_fraction);
  EXPECT_EQ(a.functions.mass_fraction, b.functions.mass_fraction);
  EXPECT_EQ(a.surface.mesh.vertices, b.surface.mesh.vertices);
  EXPECT_EQ(a.surface.mesh.triangles, b.surface.mesh.triangles);
  EXPECT_EQ(a.surface.mesh.region, b.surface.mesh.region);
  EXPECT_EQ(a.surface.mesh.region_names, b.surface.mesh.region_names);
  EXPECT_EQ(a.surface.vertex_parameters, b.surface.vertex_parameters);
  EXPECT_EQ(a.surface.vertex_cell, b.surface.vertex_cell);
  EXPECT_EQ(a.surface.accepted_leak, b.surface.accepted_leak);
  EXPECT_EQ(a.surface.bodies, b.surface.bodies);
  EXPECT_EQ(a.surface.quadrature.offsets, b.surface.quadrature.offsets);
  EXPECT_EQ(a.surface.quadrature.parameters, b.surface.quadrature.parameters);
  EXPECT_EQ(a.surface.quadrature.weights, b.surface.quadrature.weights);
  EXPECT_EQ(a.surface.quadrature.normals, b.surface.quadrature.normals);
  EXPECT_EQ(a.surface.quadrature.triangle, b.surface.quadrature.triangle);
  EXPECT_EQ(a.curves.names, b.curves.names);
  EXPECT_EQ(a.curves.offsets, b.curves.offsets);
  EXPECT_EQ(a.curves.points, b.curves.points);
  EXPECT_EQ(a.markers.names, b.markers.names);
  EXPECT_EQ(a.markers.positions, b.markers.positions);
  expect_equal(a.provenance, b.provenance);
}

} // namespace iga::test
