// How far a point lies inside the solid's part of one span: what points are allowed to move by.
#pragma once

#include "format/model/simd.hpp"
#include "preprocessor/candidates.hpp"

#include <vector>

namespace iga::prep {

/// All coordinates and distances in box units of the LocalSurface. One object per thread, buffers are kept.
class PieceInterior {
 public:
  /// @param caster  attached to the same surface; both must stay as they are while this is in use
  void attach(const LocalSurface& surface, LineCaster& caster);

  /// A lower bound of the distance from x, a point inside, to the surface and to the faces of the box. Exact up to
  /// rounding but for solids that are half-spaces cut with the box, where the distance to the planes bounds it.
  double clearance(const Point3& x);
  /// The same for a point that came from `inside`, a point in the solid; at most 0 where it left the solid.
  double clearance(const Point3& x, const Point3& inside);

  /// The solid is the box cut by half-spaces.
  bool is_convex() const { return convex_; }

 private:
  struct Plane {
    Point3 n; ///< outward, unit length
    double offset;
  };
  struct Facet {
    Point3 a, ab, ac; ///< corner and edges
  };
  void find_planes();
  void split_facets();
  double distance(const Point3& x) const;
  bool left(const Point3& x, const Point3& inside) const;

  const LocalSurface* surface_ = nullptr;
  LineCaster* caster_ = nullptr;
  bool convex_ = false;
  std::vector<Plane> planes_;
  std::vector<Facet> facets_;                       // of solids that are not convex
  std::array<std::vector<Lanes>, 3> lower_, upper_; // their boxes, eight side by side
};

} // namespace iga::prep
