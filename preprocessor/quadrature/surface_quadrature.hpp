// The embedded surface tied to the grid: points with areas and normals per span, vertices with owning spans.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/trim/trim.hpp"

namespace iga::prep {

enum class SurfaceRule {
  Exact,   ///< to total degree 3 max(p) on every piece of the surface
  Reduced, ///< fewer points on pieces that are small beside a span, down to one; exact to degree 1 at least: areas,
           ///< normals and volumes are
};

/// "exact" or "reduced". @throws InputError for other names
SurfaceRule surface_rule(const std::string& name);

/// Points exact for the rule's degree on every piece of the surface, positive weights; every piece and every vertex
/// is owned by a cell: one in a grid plane goes to the neighbour on the material side, one of a piece left out or of a
/// snapped or dropped span to the nearest cell that is reached through the solid, its parameters moved into that cell's
/// closed span. Σ weights per region = area of the region to
/// rounding.
///
/// Moving shifts a piece of a snapped span by at most the sliver tolerance (in spans) and a piece of a dropped span by
/// up to the distance of the nearest active span; all other pieces stay where they are. Hence Σ n w = 0 to rounding
/// always, and Σ x·n w = 3 volume to rounding unless spans were snapped or dropped: then it may differ by sliver
/// tolerance · largest span size · area of the surface in snapped spans (plus the same with the larger shift for
/// dropped spans).
/// @throws InputError where no span is active
EmbeddedSurface make_embedded_surface(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                                      SurfaceRule rule = SurfaceRule::Exact);

} // namespace iga::prep
