// Which cell a place on the surface belongs to: one that owns surface of the triangle it lies on. What lies on the
// other side of a gap is never a candidate, however near it is.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <span>

namespace iga::solve {

struct CellPlace {
  std::int64_t cell = -1;
  double distance = 0; ///< of the place from the cell's closed span, in spans; 0 where the span holds it
  Point3 parameter{};  ///< of the place, moved into the closed span
};

/// Holds a reference: the model must outlive it. Safe to share between threads.
class SurfaceCells {
 public:
  explicit SurfaceCells(const TrimmedModel& model);

  /// Of the cells that own surface points of the triangle (where it has none, because it has no area: that own its
  /// vertices), the one whose closed span is nearest to the place; of several as near, the one whose span's centre lies
  /// furthest behind the triangle, then the lowest number. Where none of their spans holds the place (a rule may have
  /// no point on a small part of a triangle), cells that links join with them count too.
  /// @param u  parameter of a place on the triangle, to rounding
  CellPlace find(std::size_t triangle, const Point3& u) const;

 private:
  bool is_linked(std::int64_t a, std::int64_t b) const;

  const TrimmedModel& model_;
  std::vector<std::size_t> first_;  ///< (n_t + 1)
  std::vector<std::int64_t> cells_; ///< that own points of triangle t: [first[t], first[t + 1]), ascending
};

} // namespace iga::solve
