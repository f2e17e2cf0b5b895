// What lies inside the solid's part of one span, and how deep: what points may be and how far they may move.
#pragma once

#include "format/model/simd.hpp"
#include "preprocessor/fit/span_moments.hpp"

#include <optional>
#include <vector>

namespace iga::prep {

/// Invariant of all points of trimmed spans: `holds` was true of each. It is a proof, not an estimate: a point counts
/// as inside where a way from it to the surface was found whose crossings are all sure in spite of rounding. Where
/// rounding leaves a doubt about every way that is tried, the point counts as outside. A point that moves keeps the
/// proof as long as it moves by less than its clearance, or along a way whose crossings are all sure. All coordinates
/// and distances in box units of the LocalSurface. One object per thread, buffers are kept.
class PieceInterior {
 public:
  /// @param surface  must stay as it is while this is in use
  void attach(const LocalSurface& surface);

  /// Whether x is proven to lie in the solid. Of solids that are half-spaces cut with the box: up to rounding.
  bool holds(const Point3& x) const;
  /// Takes out the points that are not proven to lie in the solid. @param[in,out] points  (n × 3), row-major
  void keep_inside(std::vector<double>& points) const;

  /// A lower bound of the distance from x, a point inside, to the surface and to the faces of the box. Exact up to
  /// rounding but for solids that are half-spaces cut with the box, where the distance to the planes bounds it.
  double clearance(const Point3& x) const;
  /// The same for a point that came from `inside`, a point in the solid; at most 0 where it left the solid.
  double clearance(const Point3& x, const Point3& inside) const;

  /// The solid is the box cut by half-spaces.
  bool is_convex() const { return convex_; }

 private:
  struct Plane {
    Point3 n; ///< outward, unit length
    double offset;
  };
  struct Facet {
    Point3 a, ab, ac; ///< corner and edges
    bool needle;      ///< its plane is mostly rounding
  };
  void find_planes();
  void split_facets();
  void choose_targets();
  double distance(const Point3& x) const;
  bool left(const Point3& x, const Point3& inside) const;
  std::optional<int> winding_change(const Point3& from, const Point3& way, std::size_t skipped) const;

  const LocalSurface* surface_ = nullptr;
  bool convex_ = false;
  std::vector<Plane> planes_;
  std::vector<Facet> facets_;                       // of solids that are not convex
  std::array<std::vector<Lanes>, 3> lower_, upper_; // their boxes, eight side by side
  std::vector<std::size_t> targets_;                // facets to look at, the largest first
};

} // namespace iga::prep
