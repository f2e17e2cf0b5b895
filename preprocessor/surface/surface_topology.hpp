// The surface as the checks and repairs see it: facets with evidence of their outside, and who shares which edge.
#pragma once

#include "format/model/triangle_mesh.hpp"
#include "format/model/vec3.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace iga::prep {

/// A mesh under repair. Facets keep their order in the file; a facet made by a repair has no stored normal.
struct Surface {
  TriangleMesh mesh;
  std::vector<Point3> normals; ///< (n_t); as stored in the file, zero where unknown
};

/// One side of a facet: the edge between vertices lo < hi, walked from lo to hi or back.
struct EdgeUse {
  std::int32_t lo = 0;
  std::int32_t hi = 0;
  std::int32_t triangle = 0;
  bool forward = true;
};

/// All edges with their uses, ordered by (lo, hi, triangle). Facets with a repeated vertex add no uses.
struct EdgeTable {
  std::vector<EdgeUse> uses;
  std::vector<std::size_t> offsets; ///< (num_edges + 1)

  std::size_t num_edges() const { return offsets.size() - 1; }
  std::span<const EdgeUse> edge(std::size_t e) const {
    return std::span(uses).subspan(offsets[e], offsets[e + 1] - offsets[e]);
  }
};

EdgeTable make_edge_table(std::span<const Triangle> triangles);

/// Uses lo → hi less uses hi → lo. The trimming needs 0 on every edge (a closed chain), nothing more: it integrates
/// edges that more than two facets share exactly.
int edge_balance(std::span<const EdgeUse> uses);

/// What is wrong along the edges.
struct EdgeDefects {
  std::int64_t open = 0;         ///< an odd number of facets: the surface ends here
  std::int64_t non_manifold = 0; ///< more than two facets
  std::int64_t turned = 0;       ///< an even number of facets that do not cancel: neighbours disagree about the outside
  Point3 first_open{};           ///< middle of the first open edge, length
  Point3 first_turned{};
};
EdgeDefects find_edge_defects(const TriangleMesh& mesh, const EdgeTable& edges);

/// True where every edge is balanced.
bool is_closed_chain(const EdgeTable& edges);

/// Keeps the facets marked true; vertices without facets go too. Order is kept.
void keep_triangles(Surface& surface, const std::vector<bool>& keep);

/// Turns facet t round.
void turn_triangle(Surface& surface, std::size_t t);

/// Length of the bounding box's diagonal.
double diagonal(const Box3& box);

/// Corner i of facet t.
inline const Point3& corner(const TriangleMesh& mesh, std::size_t t, std::size_t i) {
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])];
}
/// Twice the facet's area times its normal.
Point3 area_vector(const TriangleMesh& mesh, std::size_t t);

} // namespace iga::prep
