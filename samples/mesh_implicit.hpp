// A smooth implicit solid → closed triangle surface with well-shaped triangles.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <functional>

namespace iga::samples {

/// Negative inside the solid, positive outside; close to a distance near the surface.
using ImplicitSolid = std::function<double(const Point3&)>;

struct ImplicitMeshOptions {
  Point3 inside{};           ///< a point in the solid
  double radius = 1;         ///< of a ball about `inside` that holds the whole solid, length
  double min_angle = 26;     ///< degrees; Delaunay refinement ends for bounds up to 30
  double max_size = 1;       ///< circumradius of a triangle, length
  double max_distance = 0.1; ///< between a triangle and the surface, length
};

/// Delaunay refinement (Boissonnat & Oudot 2005, CGAL's 3D surface mesh generation), then every vertex is moved onto
/// the zero set by Newton steps. Same input and same state of CGAL's default random numbers, same triangles.
TriangleMesh mesh_implicit(const ImplicitSolid& solid, const ImplicitMeshOptions& options);

} // namespace iga::samples
