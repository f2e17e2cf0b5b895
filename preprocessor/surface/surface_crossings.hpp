// Where facets cross each other: material counted twice, or a surface folded through itself.
#pragma once

#include "preprocessor/surface/surface_shells.hpp"

#include <utility>

namespace iga::prep {

/// Facet pairs that cross deeper than the tolerance, or cover the same plane in the same direction. At such a crossing
/// the winding number takes three values, so one of them is neither 0 nor 1. Bodies that merely touch do not count.
struct Crossings {
  std::int64_t pairs = 0;
  double depth = 0;                                            ///< of the deepest pair, length
  Point3 where{};                                              ///< at the deepest pair
  std::vector<std::pair<std::int32_t, std::int32_t>> facets;   ///< all crossing pairs, ascending
  std::vector<std::pair<std::int32_t, std::int32_t>> shells;   ///< distinct shells that cross each other, ascending
  std::vector<std::pair<std::int32_t, std::int32_t>> touching; ///< distinct shells whose facets' boxes meet, ascending
};

/// @param shells     of the same mesh
/// @param tolerance  depth up to which facets only touch, length
Crossings find_crossings(const TriangleMesh& mesh, const Shells& shells, double tolerance);

} // namespace iga::prep
