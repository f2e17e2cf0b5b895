// Candidate points for the moment fitting: lines shot through one span's own surface pieces, points inside the
// intervals that lie in the solid. Every candidate is inside by construction.
#pragma once

#include "preprocessor/span_moments.hpp"

#include <vector>

namespace iga::prep {

/// Lines through one span. All coordinates in box units of the LocalSurface.
class LineCaster {
 public:
  void attach(const LocalSurface& surface) { surface_ = &surface; }

  /// Axis along which the surface shows the largest projected area: lines along it are sure to meet the solid.
  std::size_t main_axis() const;

  /// Shoots the lines (b_i, c_j) along `axis` (b, c: the other two axes, ascending) and appends points of Gauss rules
  /// on every interval inside the solid: `points_per_line` on an interval as long as the box, fewer on shorter ones,
  /// but at least `min_points`.
  /// @param[in,out] points  (n × 3), row-major, appended
  void append_candidates(std::size_t axis, std::span<const double> b, std::span<const double> c, int points_per_line,
                         int min_points, std::vector<double>& points);

  /// Rays from points of the pieces straight into the solid, up to where they leave it: they find what regular lines
  /// miss, parts that are thin in two directions. Appends a Gauss rule of `points_per_ray` points a ray.
  /// @param degree    the rays start at the points of a triangle rule of this degree
  /// @param max_rays  at most about this many
  void append_inward_candidates(int degree, std::size_t max_rays, int points_per_ray, std::vector<double>& points);

  /// Whether a point not on the surface lies in the solid.
  bool inside(const Point3& x);

 private:
  struct Crossing {
    double at; ///< coordinate along the axis
    int sign;  ///< +1 where the line leaves the solid in the positive direction, 0 where it runs along a piece
  };
  void cast(std::size_t axis, std::span<const double> b, std::span<const double> c);
  bool inside_by_piece(const Point3& x);
  void cast_ray(const Point3& x, const Point3& ray);

  const LocalSurface* surface_ = nullptr;
  std::vector<std::vector<Crossing>> lines_; // of the last cast, b fastest
  std::vector<std::vector<Crossing>> probe_; // spare, for inside() while lines_ is in use
  std::vector<Crossing> ray_;                // of the last cast_ray
};

} // namespace iga::prep
