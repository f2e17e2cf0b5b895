// Gaps that functions reach across: what lies on their two sides is then tied together.
#pragma once

#include "preprocessor/walls/surface_chords.hpp"

namespace iga::prep {

struct NarrowGap {
  double width = 0;     ///< length
  double spans = 0;     ///< the same in spans, across the gap
  Point3 where{};       ///< position on one of its sides
  double span_size = 0; ///< of cubic spans over which no function reaches, length
  double num_spans = 0; ///< of them that the solid would fill
};

/// The narrowest gap that functions of degree p, p + 1 spans long, reach across: two places of the surface that see
/// each other through air, closer than three quarters of that along the grid's axes, and whose material is not
/// connected within p + 1 spans around the middle between them. None where there is no such gap: a bore, a fillet or
/// the bottom of a groove connect their sides nearby.
///
/// Material of two places that see each other is connected within a block of spans exactly where the surface between
/// them is (a block has no holes of its own), so the surface's triangles and their edges in the block tell.
/// Looks at the samples only, and at no more than three hundred of them, evenly from the narrowest on.
/// @param tree  over model.surface.mesh
std::optional<NarrowGap> find_narrow_gap(const TrimmedModel& model, const TriangleTree& tree,
                                         const std::vector<SurfaceSample>& samples);

} // namespace iga::prep
