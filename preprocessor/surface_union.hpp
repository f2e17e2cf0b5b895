// Unites overlapping bodies, so that nothing counts twice.
#pragma once

#include "preprocessor/surface_shells.hpp"

#include <optional>
#include <string>

namespace iga::prep {

struct Uniting {
  std::int64_t bodies = 0; ///< bodies that went into unions
  std::int64_t unions = 0; ///< bodies that came out
  std::string failure;     ///< why the union failed; empty on success
};

/// Replaces bodies that cross each other by their union, with exact arithmetic (CGAL's corefinement); other bodies are
/// left alone. Facets keep their regions; vertices that stay keep their bits.
/// @param crossing  pairs of shells that cross
/// @pre orient_shells has run: closed shells, bodies outwards, cavities inwards
Uniting unite_bodies(Surface& surface, const Shells& shells,
                     std::span<const std::pair<std::int32_t, std::int32_t>> crossing);

} // namespace iga::prep
