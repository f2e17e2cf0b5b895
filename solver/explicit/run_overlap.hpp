// Bodies that lie inside each other before a run begins: contact would not see what is deeper than half a wall.
#pragma once

#include "solver/explicit/contact_body.hpp"
#include "solver/explicit/run_file.hpp"

namespace iga::solve {

/// Looks at the pairs of all contacts: vertices of each side (at most some thousands of those in the other's box) and
/// the centres of rigid bodies. Self-contact is left out.
/// @throws InputError with the contact's place in the run file, where and how deep, for depths beyond half a span
void refuse_deep_overlap(const ExplicitRun& run, const std::vector<ContactSurface>& surfaces);

} // namespace iga::solve
