// A surface whose triangles are far finer than spans, made coarser for contact.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <vector>

namespace iga::solve {

struct CoarsenSettings {
  double shortest = 0;  ///< edges below this are merged where all else allows it, length
  double longest = 0;   ///< no new edge is longer, length
  double deviation = 0; ///< no vertex that is merged lies farther from the new triangles, length
};

struct CoarseSurface {
  TriangleMesh mesh;
  std::vector<std::int32_t> vertex; ///< number in the given mesh of each vertex, ascending: none is moved
  double deviation = 0;             ///< largest distance of a merged vertex from the triangles that replace its own
};

/// Merges vertices into neighbours, along the shortest edges first. What stays is where it was, so all vertices lie on
/// the true surface. Closed surfaces stay closed and keep their connections. Corners, ends and bends of sharp edges
/// (30° and more), borders and lines between regions stay; along straight ones vertices are merged. The order depends
/// on the mesh alone.
CoarseSurface coarsen(const TriangleMesh& mesh, const CoarsenSettings& settings);

} // namespace iga::solve
