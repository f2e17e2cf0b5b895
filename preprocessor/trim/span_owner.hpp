// Which active span owns a point of the surface: the one that holds it, on the side of the material where it lies in a
// grid plane, the nearest one where its own span is not active.
#pragma once

#include "preprocessor/trim/trim.hpp"

#include <cstdint>

namespace iga::prep {

/// Holds references: grid and trimming must outlive it. Safe to share between threads.
class SpanOwner {
 public:
  SpanOwner(const SplineGrid& grid, const Trimming& trimming);

  /// Linear number of the active span that owns a surface point.
  /// Among active spans whose closed box holds the point: the one whose centre lies furthest against the outward
  /// normal. Where there is none (the point lies in a snapped or dropped span): the nearest active span, by the
  /// distance from the point to its closed box in span units; of several equally near ones again the one on the
  /// material side.
  /// @param xi      span units (see SurfacePieces)
  /// @param normal  outward, in the grid's frame, any length
  /// @pre at least one span is active
  std::int64_t find(const Point3& xi, const Point3& normal) const;

  /// Cell of an active span to which a place on the surface belongs: where there are several, the one whose polygons
  /// are nearest. A place on the surface of a cell and the nearest of its polygons have nothing but the solid between
  /// them.
  /// @param touched  entry that the place was cut for: its own cell where it has one in this span; -1 where not known
  std::int64_t cell(std::int64_t span, const Point3& xi, std::int64_t touched) const;

  /// Parameters of a point given in span units, moved into the closed box of a span.
  Point3 parameters_in(std::int64_t span, const Point3& xi) const;

 private:
  struct Choice;
  void consider(const Index3& ijk, const Point3& xi, const Point3& normal, Choice& best) const;

  const SplineGrid& grid_;
  const Trimming& trimming_;
};

} // namespace iga::prep
