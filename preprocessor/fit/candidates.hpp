// Candidate points for the moment fitting: lines shot through one span's own surface pieces, points inside the
// intervals that lie in the solid. Lines that graze edges or thin parts may err: PieceInterior judges every candidate.
#pragma once

#include "preprocessor/fit/piece_interior.hpp"

#include <vector>

namespace iga::prep {

/// Lines through one span. All coordinates in box units of the LocalSurface.
class LineCaster {
 public:
  /// @param interior  attached to the same surface; both must stay as they are while this is in use
  void attach(const LocalSurface& surface, const PieceInterior& interior) {
    surface_ = &surface;
    interior_ = &interior;
  }

  /// Axis along which the surface shows the largest projected area: lines along it are sure to meet the solid.
  std::size_t main_axis() const;

  /// Shoots the lines (b_i, c_j) along `axis` (b, c: the other two axes, ascending) and appends points of Gauss rules
  /// on every interval inside the solid: `points_per_line` on an interval as long as the box, fewer on shorter ones,
  /// but at least `min_points`. Every candidate is proven to lie inside.
  /// @param[in,out] points  (n × 3), row-major, appended
  void append_candidates(std::size_t axis, std::span<const double> b, std::span<const double> c, int points_per_line,
                         int min_points, std::vector<double>& points);

  /// Rays from points of the pieces straight into the solid, up to where they leave it: they find what regular lines
  /// miss, parts that are thin in two directions. Appends a Gauss rule of `points_per_ray` points a ray.
  /// @param degree    the rays start at the points of a triangle rule of this degree
  /// @param max_rays  at most about this many
  void append_inward_candidates(int degree, std::size_t max_rays, int points_per_ray, std::vector<double>& points);

 private:
  struct Crossing {
    double at; ///< coordinate along the axis
    int sign;  ///< +1 where the line leaves the solid in the positive direction, 0 where it runs along a piece
  };
  void cast(std::size_t axis, std::span<const double> b, std::span<const double> c);
  void cast_ray(const Point3& x, const Point3& ray);
  void append_proven(std::vector<double>& points);

  const LocalSurface* surface_ = nullptr;
  const PieceInterior* interior_ = nullptr;
  std::vector<std::vector<Crossing>> lines_; // of the last cast, b fastest
  std::vector<Crossing> ray_;                // of the last cast_ray
  std::vector<double> found_;                // candidates not yet judged
};

} // namespace iga::prep
