// Connected sets of lattice nodes inside the solid: within each touched span, and the links between neighbouring spans.
#pragma once

#include "preprocessor/connectivity/lattice_nodes.hpp"
#include "preprocessor/trim/clip.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace iga::prep {

/// Joins a set of a touched span to a set of the same span (step 0) or of a neighbour.
struct NodeLink {
  std::array<std::int8_t, 3> step{}; ///< to the neighbour, -1 … 1 per direction
  std::uint8_t own = 0;
  std::uint8_t other = 0; ///< set of the neighbour; 0 for an interior span without surface, which is one set
};

/// Sets of all touched spans and the links between them.
struct NodeSets {
  std::vector<std::int64_t> first_set; ///< (num_touched + 1)
  std::vector<std::int32_t> set_size; ///< (num_sets); nodes that belong to a lattice cube with all eight corners in the
                                      ///< solid, so that walls thinner than the spacing count 0
  std::vector<std::int64_t> first_link; ///< (num_touched + 1)
  std::vector<NodeLink> links;          ///< every link once, or once from either side
};

/// Two nodes in the solid are joined where they are neighbours on a line and the surface does not pass between them, or
/// diagonal neighbours in a lattice plane whose other two corners lie outside and whose connecting segment meets no
/// surface piece: an oblique wall of about the lattice spacing would fall apart without the latter.
/// @param state  (num_spans) of the trimming; decides the spans without surface
NodeSets build_node_sets(const SplineGrid& grid, const SurfacePieces& pieces, const std::vector<std::uint8_t>& state,
                         const LatticeNodes& nodes);

} // namespace iga::prep
