// Fewer points for one trimmed span: points are taken out and the others moved until the moments are exact again.
#pragma once

#include "preprocessor/reduce/point_relocation.hpp"
#include "preprocessor/reduce/reduction_counts.hpp"

namespace iga::prep {

/// Node elimination (Xiao & Gimbutas 2010; Bremer, Gimbutas & Rokhlin 2010): a point brings four unknowns, its weight
/// and its place, so a quarter as many points as moments can do. One object per thread, buffers are kept.
class PointReducer {
 public:
  /// @param interior  of the span; must stay attached to it while this is in use
  void attach(const PieceInterior& interior) { relocator_.attach(interior); }

  /// Reduces a rule of the attached span in place: weights stay positive, points inside the solid, and the residual
  /// ends at or below `tolerance` (mostly at rounding). A rule that cannot be reduced is left as it was.
  /// @param moments     tensor Legendre moments up to `degree`, box units
  /// @param fixed_axis  points keep their coordinate along it (prisms), or -1
  /// @param least       no fewer points than this
  void reduce(const std::array<int, 3>& degree, std::span<const double> moments, int fixed_axis, std::size_t least,
              double tolerance, PointSet& points);

  const ReductionCounts& counts() const { return counts_; }

 private:
  bool eliminate(std::size_t least, double loose, double tolerance, const PointSet& points);
  bool remove_some(std::size_t least, double loose, Metric metric, bool& several);
  bool remove_bounded(double loose);
  void sort_by_cost();

  PointRelocator relocator_;
  MovingPoints state_, next_;
  std::vector<double> cost_;
  std::vector<std::size_t> order_; // points, the cheapest to remove first
  ReductionCounts counts_, run_;
};

} // namespace iga::prep
