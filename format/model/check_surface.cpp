// The embedded surface: ownership by cells, areas, and the integrals that prove it closed.
#include "format/model/model_check.hpp"

#include <algorithm>
#include <cmath>

namespace iga::detail {

namespace {

bool finite(const Point3& x) {
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}
Point3 minus(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm(const Point3& a) {
  return std::sqrt(dot(a, a));
}
Point3 row(const std::vector<double>& v, std::size_t i) {
  return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
}

bool mesh_fits(const TriangleMesh& mesh, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "surface");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!finite(mesh.vertices[v])) kind.add("vertex {} is not finite", v);
  const auto num_vertices = static_cast<std::int64_t>(mesh.vertices.size());
  const auto num_regions = static_cast<std::int64_t>(mesh.region_names.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::int32_t v : mesh.triangles[t])
      if (v < 0 || v >= num_vertices) kind.add("triangle {} names vertex {} of {}", t, v, num_vertices);
    if (mesh.region[t] < 0 || mesh.region[t] >= num_regions)
      kind.add("triangle {} names region {} of {}", t, mesh.region[t], num_regions);
  }
  return kind.empty();
}

void check_vertices(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind owner(problems, limit, "surface/vertex_cell");
  ProblemKind inside(problems, limit, "surface/vertex_parameters");
  const Point3 rounding = parameter_rounding(m.grid);
  for (std::size_t v = 0; v < m.surface.vertex_cell.size(); ++v) {
    const std::int64_t cell = m.surface.vertex_cell[v];
    const double* u = &m.surface.vertex_parameters[3 * v];
    if (cell < 0 || cell >= static_cast<std::int64_t>(m.num_cells()))
      owner.add("vertex {} belongs to cell {} of {}", v, cell, m.num_cells());
    else if (const std::int64_t span = m.cells.span[static_cast<std::size_t>(cell)];
             !in_closed_span(m.grid, m.grid.span_index(span), u, rounding))
      inside.add("vertex {} ({}, {}, {}) lies outside its span {}", v, u[0], u[1], u[2], span);
  }
}

struct SurfaceIntegrals {
  std::vector<Sum> region_area;
  Sum area;
  std::array<Sum, 3> normal; ///< ∮ n dA
  Sum volume;                ///< ∮ x·n dA / 3, x on the plane of the point's triangle
};

// Points that lie where they should; their integrals. A point clamped to a span's face leaves its triangle by the
// sliver depth at most (unless spans were dropped), so the divergence is taken on the triangle's plane, where it is
// exact.
SurfaceIntegrals check_points(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  const auto& q = m.surface.quadrature;
  const auto& mesh = m.surface.mesh;
  ProblemKind inside(problems, limit, "surface/quadrature/parameters");
  ProblemKind weight(problems, limit, "surface/quadrature/weights");
  ProblemKind unit(problems, limit, "surface/quadrature/normals");
  ProblemKind index(problems, limit, "surface/quadrature/triangle");
  ProblemKind off(problems, limit, "surface/quadrature");
  const Point3 rounding = parameter_rounding(m.grid);
  const double depth = surface_depth(m);
  SurfaceIntegrals sums{std::vector<Sum>(mesh.region_names.size()), {}, {}, {}};
  Point3 origin{}; // the grid's centre: a part far from the origin would lose digits otherwise
  for (std::size_t d = 0; d < 3; ++d) origin[d] = m.grid.A()[d] + 0.5 * (m.grid.B()[d] - m.grid.A()[d]);
  for (std::size_t a = 0; a < m.cells.span.size(); ++a) {
    const Index3 ijk = m.grid.span_index(m.cells.span[a]);
    for (auto i = static_cast<std::size_t>(q.offsets[a]); i < static_cast<std::size_t>(q.offsets[a + 1]); ++i) {
      const Point3 u = row(q.parameters, i), n = row(q.normals, i);
      const double w = q.weights[i];
      const std::int32_t t = q.triangle[i];
      if (!in_closed_span(m.grid, ijk, u.data(), rounding))
        inside.add("point {} ({}, {}, {}) lies outside its span {}", i, u[0], u[1], u[2], m.cells.span[a]);
      if (!(w > 0 && std::isfinite(w))) weight.add("point {} has weight {}, expected a positive number", i, w);
      if (!(std::abs(norm(n) - 1) <= 1e-9)) unit.add("point {} has a normal of length {}, expected 1", i, norm(n));
      if (t < 0 || t >= static_cast<std::int64_t>(mesh.triangles.size())) {
        index.add("point {} names triangle {} of {}", i, t, mesh.triangles.size());
        continue;
      }
      const auto tt = static_cast<std::size_t>(t);
      const Point3& corner = mesh.vertices[static_cast<std::size_t>(mesh.triangles[tt][0])];
      // Where leaks were accepted, a piece may have no material near it.
      if (m.quadrature.dropped_spans == 0 && m.surface.accepted_leak == 0)
        if (const double distance = distance_to_triangle(mesh, tt, m.grid.to_position(u)); !(distance <= depth))
          off.add("point {} lies {:.3g} off its triangle {}, expected at most {:.3g}", i, distance, t, depth);
      sums.region_area[static_cast<std::size_t>(mesh.region[tt])].add(w);
      sums.area.add(w);
      for (std::size_t d = 0; d < 3; ++d) sums.normal[d].add(w * n[d]);
      sums.volume.add(w * dot(minus(corner, origin), n) / 3);
    }
  }
  return sums;
}

void check_integrals(const TrimmedModel& m, const SurfaceIntegrals& sums, int limit,
                     std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "surface integrals");
  const auto& mesh = m.surface.mesh;
  std::vector<Sum> area(mesh.region_names.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])]; };
    const Point3 e = minus(corner(1), corner(0)), f = minus(corner(2), corner(0));
    area[static_cast<std::size_t>(mesh.region[t])].add(
        0.5 * norm({e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]}));
  }
  const double total = sums.area.value();
  for (std::size_t r = 0; r < area.size(); ++r)
    if (!(std::abs(sums.region_area[r].value() - area[r].value()) <= integral_tolerance * area[r].value()))
      kind.add("weights of region '{}' sum to {:.17g}, expected its area {:.17g}", mesh.region_names[r],
               sums.region_area[r].value(), area[r].value());
  const Point3 n{sums.normal[0].value(), sums.normal[1].value(), sums.normal[2].value()};
  if (!(norm(n) <= integral_tolerance * total))
    kind.add("∮ n dA = ({:.3g}, {:.3g}, {:.3g}), expected 0 to {:.3g}", n[0], n[1], n[2], integral_tolerance * total);
  const double V = m.quadrature.part_volume;
  if (!(std::abs(sums.volume.value() - V) <= integral_tolerance * V))
    kind.add("∮ x·n dA / 3 = {:.17g}, expected part_volume {:.17g}", sums.volume.value(), V);
}

} // namespace
} // namespace iga::detail

double iga::surface_depth(const TrimmedModel& m) {
  const Point3 h = m.grid.span_size(), rounding = detail::parameter_rounding(m.grid);
  return std::hypot(h[0], h[1], h[2]) *
         (m.quadrature.sliver_tolerance + std::max({detail::inside_tolerance, rounding[0], rounding[1], rounding[2]}));
}

namespace iga::detail {

void check_surface(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  if (!mesh_fits(m.surface.mesh, limit, problems)) return;
  check_vertices(m, limit, problems);
  {
    ProblemKind kind(problems, limit, "surface/quadrature/offsets");
    check_offsets(m.surface.quadrature.offsets, m.surface.quadrature.weights.size(), kind);
    if (!kind.empty()) return;
  }
  const std::size_t before = problems.size();
  const SurfaceIntegrals sums = check_points(m, limit, problems);
  if (problems.size() == before && m.surface.accepted_leak == 0) check_integrals(m, sums, limit, problems);
}

} // namespace iga::detail
