// What a user checks first, for people and for scripts.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/quadrature/quadrature_options.hpp"
#include "preprocessor/walls/narrow_gaps.hpp"
#include "preprocessor/walls/wall_thickness.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace iga::prep {

/// Light functions with the part centred in the grid and after --optimise-offset.
struct OffsetGain {
  std::int64_t light_before = 0;
  std::int64_t light_after = 0;
  int evaluations = 0;
};

/// Everything the report says, collected by the pipeline.
struct PrepReport {
  std::string input, output;
  int interrupted_by = 0; ///< signal that ended the reduction of points early, 0 for none
  bool reused = false;    ///< a matching file stood there already: what only the run itself knows is left out
  std::string format, length_unit;
  Box3 part_box; ///< position, length
  std::int64_t triangles = 0;
  int bodies = 0, cavities = 0, regions = 0;
  double area = 0;              ///< length²
  VolumeMoments surface;        ///< of the closed surface
  VolumeMoments points_moments; ///< of the quadrature points
  double trimming_error = 0;    ///< |Σ fractions · span volume - surface's volume| / surface's volume
  double volume_error = 0;      ///< |Σ weights - (surface + snapped - dropped)| / surface's volume
  double centroid_error = 0;    ///< distance of the two centroids / diagonal of the part's box
  double inertia_error = 0;     ///< largest difference of a second moment / trace of the surface's
  double area_error = 0;        ///< |Σ surface weights - area| / area
  SplineGrid grid;
  std::int64_t interior = 0, trimmed = 0, exterior = 0; ///< spans
  std::int64_t points = 0, points_interior = 0, points_trimmed = 0, surface_points = 0;
  QuadratureInfo quadrature;
  QuadratureCounts counts;
  std::int64_t functions = 0, light_functions = 0;
  std::int64_t cells = 0, split_spans = 0; ///< cells, and spans that hold several
  std::int64_t copied_functions = 0;       ///< B-splines with several copies
  std::int64_t gap_end_cells = 0;          ///< cells with functions of their own, where gaps end
  std::int64_t components = 0;             ///< of the cells under their links
  std::int64_t pieces = 0;                 ///< of spans, before those that see the same functions became one cell
  std::optional<OffsetGain> offset;
  ThinWalls walls;
  std::optional<NarrowGap> narrowest_gap;
  std::vector<std::string> findings, warnings;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
  double peak_memory_mib = 0;
};

/// Fills in all that the model itself tells: grid, spans, points, volumes and moments, area, functions.
void describe_model(PrepReport& report, const TrimmedModel& model);
/// Measures walls and gaps. @param tree  over model.surface.mesh
void measure_walls_and_gaps(PrepReport& report, const TrimmedModel& model, const TriangleTree& tree);
/// Highest memory use of this process so far, MiB.
double peak_memory_mib();

/// Aligned lines for people, ending in a newline.
std::string human_report(const PrepReport& report);
/// One JSON object without a newline.
std::string json_report(const PrepReport& report);

} // namespace iga::prep
