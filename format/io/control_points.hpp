// Control points of a grid, block by block: a fine grid's table is never held whole.
#pragma once

#include "format/model/spline_grid.hpp"

#include <span>
#include <vector>

namespace iga::io {

/// Control points of consecutive functions, in space.
class ControlPoints {
 public:
  explicit ControlPoints(const SplineGrid& grid);
  /// @param[out] block  (n × 3), row-major: functions first … first + n - 1
  void fill(std::int64_t first, std::span<double> block) const;

 private:
  const SplineGrid& grid_;
  std::array<std::vector<double>, 3> greville_;
};

} // namespace iga::io
