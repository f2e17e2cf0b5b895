// Eight 3×3 tensors side by side: what material laws work on.
#pragma once

#include "format/model/simd.hpp"

#include <cstdint>

namespace iga::solve {

/// Result of a comparison of Lanes: -1 where true, 0 where false. Select with `mask ? a : b`.
using LaneMask [[gnu::vector_size(8 * sizeof(std::int64_t))]] = std::int64_t;

/// Eight tensors A_ab, row-major: (a, b) is component 3 a + b.
struct TensorLanes {
  Lanes c[9];

  Lanes& operator()(int a, int b) { return c[3 * a + b]; }
  const Lanes& operator()(int a, int b) const { return c[3 * a + b]; }
};

/// Eight symmetric tensors in the order xx yy zz xy yz zx (tensor components, no engineering shear).
struct SymmetricLanes {
  Lanes c[6];
};

} // namespace iga::solve
