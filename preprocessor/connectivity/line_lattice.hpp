// Three families of regular lines through the grid that share their lattice points, and where they cross the surface.
// Crossings come from the triangles themselves, not from the clipped pieces: a judge independent of the trimming.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <cstdint>
#include <vector>

namespace iga::prep {

/// n lattice coordinates per span and direction; coordinate L along d is (L + offset_d) / n in span units. The offsets
/// are irrational and differ per direction, so that lines miss the edges of symmetric parts and their diagonals.
struct LineLattice {
  std::int64_t per_span = 1;

  double coordinate(std::size_t d, std::int64_t L) const {
    constexpr std::array<double, 3> offset{0.41421356237309515, 0.7320508075688772, 0.2360679774997898}; // √2, √3, √5
    return (static_cast<double>(L) + offset[d]) / static_cast<double>(per_span);
  }
};

/// Where a line crosses the surface. Lines along axis d in one slab of spans (fixed index along e = d + 1) are numbered
/// line = lf · n + le with lf the lattice number along f = d + 2 and le in [0, n) the one along e within the slab.
struct LineCrossing {
  std::int64_t line = 0;
  double at = 0;  ///< span units along the line
  int change = 0; ///< of the winding number on the way up: +1 enters, -1 leaves
};

/// Lines along one axis against all triangles, slab by slab. Safe to share between threads.
class LineShooter {
 public:
  /// @param xi  (n_v); mesh vertices in span units; must outlive the shooter, as must the mesh
  LineShooter(const SplineGrid& grid, const TriangleMesh& mesh, const std::vector<Point3>& xi, LineLattice lattice,
              std::size_t axis);

  std::int64_t num_slabs() const { return static_cast<std::int64_t>(first_.size()) - 1; }
  /// All crossings of a slab's lines, sorted by line, then along it. On a closed surface the changes of every line sum
  /// to exactly 0: an edge is crossed at the same bits seen from either of its triangles, half-open at its ends.
  void shoot(std::int64_t slab, std::vector<LineCrossing>& crossings) const;

 private:
  void cross_triangle(const Triangle& triangle, std::int64_t slab, std::vector<LineCrossing>& crossings) const;

  const TriangleMesh& mesh_;
  const std::vector<Point3>& xi_;
  LineLattice lattice_;
  std::size_t d_, e_, f_;
  std::vector<std::int64_t> first_;     // (num_slabs + 1)
  std::vector<std::int32_t> triangles_; // that reach each slab
};

} // namespace iga::prep
