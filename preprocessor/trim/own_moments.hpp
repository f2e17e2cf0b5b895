// First-order moments of polygons in one span, and how close to the span's faces they stay.
#pragma once

#include "format/model/types.hpp"

#include <array>
#include <span>

namespace iga::prep {

/// Along the three axes, relative to the span's lower corner, in span units.
struct OwnMoments {
  Point3 area{};                 ///< Σ ∫ n_d dA: net projected area
  Point3 volume{};               ///< Σ ∫ (ξ_d - i_d) n_d dA
  Point3 magnitude{};            ///< Σ |…| of the same, for the rounding bound
  Point3 far_area{};             ///< as area, but without polygons flat on a lower face
  std::array<bool, 6> touches{}; ///< a polygon that is not flat on a lower face reaches this face of the span
  double depth = 0;              ///< every polygon stays this close to one of the span's faces

  /// @param polygon  convex, at most nine corners, span units
  /// @param corner   of the span
  void add(std::span<const Point3> polygon, const Point3& corner);
};

} // namespace iga::prep
