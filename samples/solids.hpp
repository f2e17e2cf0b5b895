// Building blocks of the sample parts: closed, outward-oriented surfaces, and Boolean operations on them.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <array>
#include <vector>

namespace iga::samples {

using Point2 = std::array<double, 2>;

TriangleMesh box(const Point3& lower, const Point3& upper);
/// Subdivided icosahedron about `centre`: 20 · 4^refinement triangles, vertices on the sphere.
TriangleMesh icosphere(const Point3& centre, double radius, int refinement);
/// Torus about the z axis through `centre`, split into `around` × `section` quads, two triangles each.
TriangleMesh torus(const Point3& centre, double ring_radius, double tube_radius, int around, int section);
/// Surface of revolution about the z axis: `profile` holds (r, z) from a first point on the axis to a last one on it,
/// the solid on its left.
TriangleMesh revolved(const std::vector<Point2>& profile, int around);
/// Prism of a simple polygon (anticlockwise) between two heights along z.
TriangleMesh extrude(const std::vector<Point2>& profile, double z_low, double z_high);
TriangleMesh cylinder(const Point2& centre, double radius, double z_low, double z_high, int segments);

/// Polygon whose corners are rounded by arcs: `radius[i]` at corner i (0 keeps it sharp), `segments` per arc.
std::vector<Point2> rounded(const std::vector<Point2>& corners, const std::vector<double>& radius, int segments);

/// All triangles of both, without looking for contact between them.
TriangleMesh together(TriangleMesh a, const TriangleMesh& b);
TriangleMesh inside_out(TriangleMesh mesh);
/// x → axes · x + shift; `axes` is a rotation, row-major.
TriangleMesh moved(TriangleMesh mesh, const std::array<Point3, 3>& axes, const Point3& shift);

/// Boolean operations by corefinement (CGAL). @throws std::runtime_error where the result is no closed manifold
TriangleMesh united(const TriangleMesh& a, const TriangleMesh& b);
TriangleMesh subtracted(const TriangleMesh& a, const TriangleMesh& b);

} // namespace iga::samples
