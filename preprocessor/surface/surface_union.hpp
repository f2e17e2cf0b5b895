// The boundary of everything that a surface encloses at least once: bodies that overlap are united, a surface that
// crosses itself loses what it encloses twice.
#pragma once

#include "preprocessor/surface/surface_topology.hpp"

#include <functional>
#include <string>

namespace iga::prep {

struct Uniting {
  std::int64_t cut_facets = 0; ///< facets that were cut where they cross others
  std::string failure;         ///< why there is no union, the surface is then as before; empty on success
};

/// Cuts the listed facets where they cross each other and keeps the parts between winding number ≤ 0 and ≥ 1, with
/// exact arithmetic (Zhou, Grinspun, Zorin, Jacobson: Mesh arrangements for solid geometry, 2016). All bodies are taken
/// in one pass, so the time grows like the number of facets that cross. Facets keep their regions; other facets stay.
/// @param facets  a closed chain, bodies outwards, cavities inwards
/// @param progress  called with the share that is done, now and then; may be empty
/// @throws io::Interrupted after Ctrl-C
Uniting unite_by_winding(Surface& surface, std::span<const std::int32_t> facets,
                         const std::function<void(double share)>& progress = {});

} // namespace iga::prep
