// The handful of value types that every layer shares.
#pragma once

#include <array>
#include <cstdint>

namespace iga {

using Point3 = std::array<double, 3>;         ///< x, y, z (length) or u, v, w (parameter)
using Index3 = std::array<std::int64_t, 3>;   ///< i, j, k along the three grid axes
using Triangle = std::array<std::int32_t, 3>; ///< vertex numbers, anticlockwise seen from outside

/// Axis-aligned box, `lower[d] <= upper[d]`.
struct Box3 {
  Point3 lower{};
  Point3 upper{};
};

} // namespace iga
