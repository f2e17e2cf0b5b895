// Rigid motions that supports leave free: why a static system has no unique solution, said in the user's terms.
#pragma once

#include "solver/supports/boundary.hpp"

namespace iga::solve {

/// One line per body that can move without any support resisting: "body 1 of 2 (centre (0, 0, 5), volume 12): free to
/// move: translation along (1, 0, 0), rotation about the axis (0, 0, 1) through (0, 0, 0)". Empty where all are held.
std::vector<std::string> free_rigid_motions(const SolutionSpace& space, const NodePattern& pattern,
                                            std::span<const PreparedSupport> supports);

} // namespace iga::solve
