// Walls that are too thin for their spans.
#pragma once

#include "preprocessor/walls/surface_chords.hpp"

namespace iga::prep {

/// Spans that a wall wants across its thickness, for four functions of the lowest degree: two at p = 2, one from p = 3
/// on.
double spans_across_wall(const SplineGrid& grid);

/// The thinnest wall of a part.
struct ThinWall {
  double thickness = 0; ///< length
  double spans = 0;     ///< the same in spans, across the wall
  Point3 where{};       ///< position on its surface
  double taper = 0;     ///< mean angle between its two faces, degrees
  double span_size = 0; ///< of cubic spans that would do, length
  double num_spans = 0; ///< of them that the solid would fill
};

struct ThinWalls {
  std::optional<ThinWall> thinnest; ///< none where all walls are thick enough
  double volume_share = 0;          ///< of the solid, in walls that are too thin
};

/// A wall is where two faces look away from each other: a straight way from a place of the surface into the solid,
/// against its normal, leaves by a face whose normal is within 30 degrees of opposite (edges and corners of a box, and
/// wedges of more than 30 degrees, are no walls). Its length is the thickness; in spans it is the length of the way in
/// units of the spans along the grid's axes. Walls that lack up to 5 % of spans_across_wall are thick enough: flat
/// facets make round walls uneven by that.
///
/// The thinnest wall is not the least of all thicknesses, which the tip of any knife edge would decide. Around every
/// span with such places, in the block of 3 × 3 × 3 spans, a quarter of their area is no thicker than the block's wall;
/// the thinnest block tells.
///
/// A volume counts as thin where the way along the shortest distance to the surface, and straight back through the
/// solid, is too short in the same sense. Both look at a bounded number of places, evenly chosen.
/// @param tree  over model.surface.mesh
ThinWalls find_thin_walls(const TrimmedModel& model, const TriangleTree& tree,
                          const std::vector<SurfaceSample>& samples);

} // namespace iga::prep
