// Functions shared across a gap: two bodies, or two walls, that share a function move together.
#pragma once

#include "preprocessor/connectivity/lattice_nodes.hpp"
#include "preprocessor/trim/clip.hpp"

#include <cstdint>
#include <vector>

namespace iga::prep {

/// Functions whose support holds material that is not connected inside that support: two bodies, or two walls across a
/// gap, which share the function and so move together.
struct SharedFunctions {
  std::int64_t count = 0;
  std::int64_t first = -1; ///< linear number of the first of them
};

/// A support counts where two of its connected sets (see node_sets.hpp) each fill at least a quarter of a span. Smaller
/// ones may be the tip of an edge; walls thinner than the lattice spacing, 1 / (max degree + 2) of a span, do not count
/// at all, because the lattice cannot follow them: a gap between two such walls goes unseen.
/// @param state  (num_spans) of the trimming; decides the spans without surface
SharedFunctions find_shared_functions(const SplineGrid& grid, const SurfacePieces& pieces,
                                      const std::vector<std::uint8_t>& state, const LatticeNodes& nodes);

} // namespace iga::prep
