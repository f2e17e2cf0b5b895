// Between our flat triangles and CGAL's halfedge mesh; for the sample generator's own .cpp files.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

namespace iga::samples {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// Flat triangles of a triangulated mesh, one region.
TriangleMesh to_triangles(const SurfaceMesh& mesh);
/// @throws std::runtime_error where the triangles are no oriented manifold
SurfaceMesh to_surface_mesh(const TriangleMesh& mesh);
/// Turns all triangles round where the enclosed volume is negative.
void orient_outwards(TriangleMesh& mesh);

} // namespace iga::samples
