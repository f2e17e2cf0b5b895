// Splits the surface at the grid planes into convex pieces, each inside one knot span.
// Architecture: every later stage (moments, states, candidates, surface quadrature) works on these pieces alone.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace iga::prep {

/// Convex planar polygons with at most 9 vertices, sorted by span, then by triangle.
/// Coordinates are *span units*: along direction d the value (u_d - A_d) / h_d, so that span (i, j, k) is the unit cube
/// at (i, j, k). Half-open slabs: a piece that lies in the grid plane ξ_d = i belongs to the span with index i; in the
/// grid's last plane, to the last span.
/// Two triangles that share an edge share the bits of every vertex made on it: the pieces of a closed mesh are closed.
struct SurfacePieces {
  std::vector<std::int64_t> spans;          ///< (num_touched); linear numbers of the spans that own pieces, ascending
  std::vector<std::int64_t> offsets;        ///< (num_touched + 1); span t owns pieces [t] … [t + 1) - 1
  std::vector<std::int32_t> triangle;       ///< (num_pieces); the mesh triangle a piece was cut from
  std::vector<std::int64_t> vertex_offsets; ///< (num_pieces + 1); piece q owns vertices [q] … [q + 1) - 1
  std::vector<Point3> vertices;             ///< (num_vertices × 3); span units, in the triangle's orientation

  std::int64_t num_pieces() const { return static_cast<std::int64_t>(triangle.size()); }
  std::span<const Point3> polygon(std::int64_t piece) const {
    const auto first = vertex_offsets[static_cast<std::size_t>(piece)];
    const auto last = vertex_offsets[static_cast<std::size_t>(piece + 1)];
    return std::span(vertices).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
  }
};

/// Mesh vertices in span units (see SurfacePieces).
std::vector<Point3> to_span_units(const SplineGrid& grid, const TriangleMesh& mesh);

/// Cuts every triangle at the grid planes (z, then y, then x), in parallel; the result does not depend on the number of
/// threads. Triangles without area add pieces too (they mark spans as touched).
/// @throws InputError where a vertex lies outside the grid's box
SurfacePieces clip_to_spans(const SplineGrid& grid, const TriangleMesh& mesh);

} // namespace iga::prep
