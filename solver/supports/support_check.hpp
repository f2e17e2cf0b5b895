// Rigid motions that supports leave free: why a static system has no unique solution, said in the user's terms.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/supports/boundary.hpp"
#include "solver/supports/spring.hpp"

namespace iga::solve {

/// One line per mechanically separate body that can move without any support or spring resisting: "body 1 of 2 (centre
/// (0, 0, 5), volume 12) is free to move: translation along (1, 0, 0), rotation about the axis (0, 0, 1) through (0, 0,
/// 0)"; where the run names bodies, with the names of those that hang together in it. Empty where all are held.
/// @param pattern   of all bodies with their ties
/// @param supports  by body of the system
std::vector<std::string> free_rigid_motions(const BodySystem& system, const NodePattern& pattern,
                                            std::span<const SupportTerms> supports,
                                            std::span<const PreparedSpring> springs = {});

} // namespace iga::solve
