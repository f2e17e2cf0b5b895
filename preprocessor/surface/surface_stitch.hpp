// Closes cracks: open edges that run side by side become one. Changes the shape by at most the gap.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

namespace iga::prep {

struct Stitching {
  std::int64_t joined = 0; ///< vertices that went
  double widest = 0;       ///< widest gap closed, length
};

/// Pairs open edges whose ends lie within a gap of each other, narrowest pairs first, with a gap that grows from
/// 1e-6 · diagonal only while edges stay open. Joined vertices meet in their middle. No two corners of a facet are ever
/// joined, so no facet collapses.
/// @param max_gap    length
/// @param max_ratio  gap over the length of the shorter edge, < 1
Stitching stitch_open_edges(Surface& surface, double max_gap, double max_ratio);

} // namespace iga::prep
