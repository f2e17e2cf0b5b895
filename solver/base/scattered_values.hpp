// Values given at scattered points in space, and what they are in between.
#pragma once

#include "format/model/types.hpp"

#include <filesystem>
#include <vector>

namespace iga::solve {

/// Moving least squares: at a place a linear function is fitted to the nearest points, each weighted by
/// ((R - d) / (R d))², d its distance and R that of the last one (weights of Franke & Nielson 1980). The values at the
/// points themselves are met, linear fields are exact wherever the nearest points span space; points in one plane or on
/// one line give a function that is constant across it.
class ScatteredValues {
 public:
  /// @pre as many values as points, at least one, finite, no two points alike
  ScatteredValues(std::vector<Point3> points, std::vector<double> values);

  double at(const Point3& x) const;
  double distance_to_nearest(const Point3& x) const;
  std::size_t size() const { return points_.size(); }

 private:
  struct Near {
    double distance2;
    std::size_t point;
  };
  std::vector<Near> nearest(const Point3& x, std::size_t count) const;
  void build(std::size_t first, std::size_t last, std::size_t axis);
  void search(std::size_t first, std::size_t last, std::size_t axis, const Point3& x, std::size_t count,
              std::vector<Near>& heap) const;

  std::vector<Point3> points_; // as a balanced k-d tree: the middle one of a range splits it, axes in turn
  std::vector<double> values_;
};

/// Reads lines of four numbers x, y, z, value, separated by commas, semicolons, blanks or tabs; names above the first
/// one and lines that begin with # are passed over.
/// @throws InputError with file and line for anything else, for points given twice and for a file without points
ScatteredValues read_scattered_values(const std::filesystem::path& file);

} // namespace iga::solve
