// Rigid motions that supports leave free: why a static system has no unique solution, said in the user's terms.
#pragma once

#include "solver/boundary.hpp"

namespace iga::solve {

/// Mechanically separate bodies: parts of the mesh of spans that share no node.
struct Bodies {
  std::int64_t count = 0;
  std::vector<std::int32_t> of_node; ///< (num_nodes)
  std::vector<std::int32_t> of_span; ///< (num_spans)
};
Bodies find_bodies(const SolutionSpace& space);

/// One line per body that can move without any support resisting: "body 1 of 2 (centre (0, 0, 5), volume 12): free to
/// move: translation along (1, 0, 0), rotation about the axis (0, 0, 1) through (0, 0, 0)". Empty where all are held.
std::vector<std::string> free_rigid_motions(const SolutionSpace& space, std::span<const PreparedSupport> supports);

} // namespace iga::solve
