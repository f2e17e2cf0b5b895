// Keys of a hash over equal cubes of space: how near vertices and near edges are found.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace iga::prep {

/// Whole-number coordinates of a cube.
using SpatialBin = std::array<std::int64_t, 3>;

struct SpatialBinHash {
  std::size_t operator()(const SpatialBin& c) const {
    const auto mix = static_cast<std::uint64_t>(c[0]) * 0x9E3779B97F4A7C15ULL ^
                     static_cast<std::uint64_t>(c[1]) * 0xC2B2AE3D27D4EB4FULL ^
                     static_cast<std::uint64_t>(c[2]) * 0x165667B19E3779F9ULL;
    return static_cast<std::size_t>(mix ^ (mix >> 29));
  }
};

} // namespace iga::prep
