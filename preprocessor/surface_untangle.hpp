// Removes what a surface encloses twice where it passes through itself.
#pragma once

#include "preprocessor/surface_shells.hpp"

namespace iga::prep {

/// Splits the crossing facets of the listed shells along their intersections, with exact arithmetic (CGAL's
/// autorefinement), and keeps the facets between winding number ≤ 0 and ≥ 1: the boundary of everything enclosed at
/// least once.
/// @param tangled  shells that cross themselves
/// @return false where the result is not closed; the surface is then as before
bool untangle_shells(Surface& surface, const Shells& shells, std::span<const std::int32_t> tangled);

} // namespace iga::prep
