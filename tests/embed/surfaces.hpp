// Closed surfaces and files for the tests of the embedded surface and the winding check.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <filesystem>
#include <string>

namespace iga::test {

TriangleMesh box(const Point3& lower, const Point3& upper);
/// Octahedron subdivided `levels` times, vertices on the sphere.
TriangleMesh sphere(const Point3& centre, double radius, int levels);
/// Prism over a polygon of the (x, y) plane given anticlockwise with its triangles, between z = z0 and z1.
TriangleMesh prism(const std::vector<std::array<double, 2>>& polygon, const std::vector<Triangle>& triangles, double z0,
                   double z1);
/// All bodies in one mesh; each keeps a region of its own.
TriangleMesh join(const std::vector<TriangleMesh>& bodies);
TriangleMesh transformed(TriangleMesh mesh, const Rotation& R, const Point3& shift);
TriangleMesh flipped(TriangleMesh mesh);
/// Rotation by angles (degrees) about z, then y.
Rotation rotation(double about_z, double about_y);

/// Grid of spans of one size around a mesh with `margin` whole spans on every side; `shift` moves it by part of a span.
SplineGrid grid_around(const TriangleMesh& mesh, double size, int degree, double shift = 0,
                       const Rotation& R = identity_rotation);
/// Grid with about `count` spans along the longest side.
SplineGrid grid_with(const TriangleMesh& mesh, int count, int degree);

/// Well-formed STL with vertices welded where they lie closer than `weld` of the diagonal (0: where they are equal).
TriangleMesh read_stl(const std::filesystem::path& file, double weld = 0);
/// Path of a shared test part; empty where the folder is absent.
std::filesystem::path shared_part(const std::string& name);
/// Share of the diagonal at which a part of the shared folder `valid` must be welded to be closed (its origin notes say
/// which: most need none).
double weld_of(const std::string& name);
/// Length of the bounding box's diagonal.
double diagonal(const TriangleMesh& mesh);

} // namespace iga::test
