// Which cell owns a part of the surface: the one that it bounds; where that part bounds nothing that counts (a piece
// left out, a snapped or dropped span), the nearest one that is reached through the solid, never through a gap.
#pragma once

#include "preprocessor/trim/trim.hpp"

#include <cstdint>

namespace iga::prep {

/// Holds references: grid and trimming must outlive it. Safe to share between threads.
class SpanOwner {
 public:
  /// @param trimming  split into cells
  SpanOwner(const SplineGrid& grid, const Trimming& trimming);

  /// Cell of a polygon of the surface. One in a grid plane goes to the span on the side of the material.
  /// @param touched  entry of pieces.spans that the polygon belongs to
  /// @param middle   of the polygon, span units (see SurfacePieces)
  /// @param normal   outward, in the grid's frame, any length
  /// @pre at least one span is active
  std::int64_t cell_of_polygon(std::int64_t touched, std::int64_t polygon, const Point3& middle,
                               const Point3& normal) const;

  /// Cell of a vertex of the surface: of the nearest span in which the vertex, moved into the closed span, lies on the
  /// surface of a cell or in its solid; of several as near, the one whose centre lies furthest against the normal.
  /// @param xi      span units
  /// @param normal  outward, in the grid's frame, any length
  /// @pre at least one span is active
  std::int64_t cell_of_vertex(const Point3& xi, const Point3& normal) const;

  /// Parameters of a point given in span units, moved into the closed box of a cell's span.
  Point3 parameters_in(std::int64_t cell, const Point3& xi) const;

 private:
  struct Choice;
  enum class Accept { AnySpan, SolidAtPlace };

  Choice nearest(const Point3& xi, const Point3& normal, Accept accept) const;
  void consider(const Index3& ijk, const Point3& xi, const Point3& normal, Accept accept, Choice& best) const;
  std::pair<std::int64_t, std::int64_t> cells_of(std::int64_t span) const;
  std::int64_t cell_of_entry(std::int64_t touched) const;
  bool is_left_out(std::int64_t polygon) const;
  bool lies_within(std::int64_t span, const Point3& xi) const;
  std::int64_t whole_entry(std::int64_t touched) const;
  std::int64_t cell_at(std::int64_t span, const Point3& xi, const Point3& normal) const;
  std::int64_t cell_in(std::int64_t span, const Point3& xi, const Point3& normal) const;

  const SplineGrid& grid_;
  const Trimming& trimming_;
};

} // namespace iga::prep
