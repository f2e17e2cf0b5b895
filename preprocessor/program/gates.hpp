// What must hold before a file is written: no input may lead to a silently wrong volume.
#pragma once

#include "format/model/errors.hpp"
#include "format/model/trimmed_model.hpp"
#include "preprocessor/connectivity/cells.hpp"
#include "preprocessor/connectivity/line_winding.hpp"
#include "preprocessor/trim/trim.hpp"
#include "preprocessor/walls/wall_thickness.hpp"

#include <string>
#include <vector>

namespace iga::prep {

/// Relative bound on volumes that are equal in exact arithmetic: far above the rounding of a million pieces, far below
/// what a missing triangle or a span counted twice leaves.
constexpr double volume_tolerance = 1e-9;

/// The surface is at fault, not the grid or the settings: a surface wrapped around it would pass.
class SurfaceFault : public InputError {
 public:
  using InputError::InputError;
};

/// What was done to a surface before it is judged: messages never advise it again.
struct SurfaceTreatment {
  bool repair = false;       ///< --repair
  bool wrapped = false;      ///< a wrapped surface stands for the given one
  bool accept_leaks = false; ///< findings that come from an open surface become warnings; overlaps never do
  bool open = false;         ///< facets do not close it
};

/// Judges the trimming and the winding numbers of a surface that encloses `mesh_volume`.
/// @returns warnings, one sentence each
/// @throws SurfaceFault with what was found, where, and the option that mends it; InputError where the grid is at fault
std::vector<std::string> judge_trimming(const SplineGrid& grid, const Trimming& trimming, double mesh_volume,
                                        const SurfaceTreatment& treatment);
std::vector<std::string> judge_winding(const WindingReport& winding, const Trimming& trimming,
                                       const SurfaceTreatment& treatment);

/// A warning where the pieces of spans cannot be told, so that walls in them share functions; none else.
std::vector<std::string> judge_cells(const CellTable& cells, const SplineGrid& grid);

/// A warning where walls are too thin for their spans, with the span size that would do. An edge that merely tapers out
/// and holds next to no volume is none.
std::vector<std::string> judge_walls(const ThinWalls& walls, const SplineGrid& grid);

/// Every surface point lies on its own triangle, to the sliver depth: a wall without material beside it (its thickness
/// snapped, or none at all) would otherwise hand its points to some span far away. Not judged where spans were dropped
/// on purpose (min_fraction), nor where leaks were accepted.
/// @throws SurfaceFault with the first place and what mends it
void judge_surface_points(const TrimmedModel& model, const SurfaceTreatment& treatment);

/// Σ weights against the part's volume, plus what snapping added, less what was dropped.
/// @throws InputError where they differ by more than the larger of `volume_tolerance` and the rules' own tolerance
void judge_weights(double point_volume, const QuadratureInfo& info);

/// Volume, centroid and second moments of the points: Σ w, Σ w x / Σ w, Σ w r_a r_b about the centroid.
/// @param about  a position near the part (sums are taken relative to it), e.g. the surface's centroid
VolumeMoments point_moments(const SplineGrid& grid, const IntegrationPoints& points, const Point3& about);

} // namespace iga::prep
