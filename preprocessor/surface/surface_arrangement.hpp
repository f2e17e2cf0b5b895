// Cuts facets along their intersections, with exact arithmetic: afterwards facets meet in whole edges and vertices.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <functional>

namespace iga::prep {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;

/// Facets that meet in whole edges and vertices only, or coincide. Include in few .cpp files: slow to compile.
struct Arrangement {
  std::vector<ExactKernel::Point_3> points;
  std::vector<Triangle> triangles; ///< indices into `points`
  std::vector<std::int32_t> facet; ///< (n_t); facet of the mesh that each triangle is a part of, same orientation
  std::int64_t cut_facets = 0;     ///< facets of the mesh that were cut
};

/// The arrangement of the listed facets. Facets without area are left out: where they closed a seam, the facets beside
/// them are cut at their vertices.
/// @param progress  called with the share that is done, now and then; may be empty
/// @throws io::Interrupted after Ctrl-C
Arrangement arrange_facets(const TriangleMesh& mesh, std::span<const std::int32_t> facets,
                           const std::function<void(double share)>& progress = {});

} // namespace iga::prep
