#include "format/io/control_points.hpp"

namespace iga::io {

ControlPoints::ControlPoints(const SplineGrid& grid) : grid_(grid) {
  for (int d = 0; d < 3; ++d)
    for (std::int64_t i = 0; i < grid.knots(d).num_functions(); ++i)
      greville_[static_cast<std::size_t>(d)].push_back(grid.knots(d).greville(i));
}

void ControlPoints::fill(std::int64_t first, std::span<double> block) const {
  Index3 ijk = grid_.function_index(first);
  const Index3 n = grid_.functions();
  for (std::size_t at = 0; at < block.size(); at += 3) {
    Point3 u{};
    for (std::size_t d = 0; d < 3; ++d) u[d] = greville_[d][static_cast<std::size_t>(ijk[d])];
    const Point3 x = grid_.to_position(u);
    for (std::size_t d = 0; d < 3; ++d) block[at + d] = x[d];
    for (std::size_t d = 0; d < 2 && ++ijk[d] == n[d]; ++d) {
      ijk[d] = 0;
      if (d == 1) ++ijk[2];
    }
  }
}

} // namespace iga::io
