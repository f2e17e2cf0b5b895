// Lines and points on which supports and loads act: named curves and markers of the model, or places by coordinates.
#pragma once

#include "solver/space/surface_region.hpp"

namespace iga::solve {

/// Lines (curves by name, or one polyline) or a point (a marker by name, or a position); nothing of it: none of them.
struct PlaceChoice {
  std::vector<std::string> curves; ///< of the model, all of them
  std::vector<Point3> line;        ///< corners of a polyline; length, the part's frame
  std::string marker;              ///< of the model
  std::optional<Point3> at;        ///< length, the part's frame
  bool is_line() const { return !curves.empty() || !line.empty(); }
  bool is_point() const { return !marker.empty() || at.has_value(); }
  bool given() const { return is_line() || is_point(); }
};

/// Quadrature points along the lines, cell by cell: straight pieces cut at the span faces, degree + 1 Gauss points on
/// each; weights are lengths. Of a point: itself, with weight 1. There are no normals (zero vectors).
/// @param what  opens the message: "support 'edge'"
/// @throws InputError for names that the model lacks, lines without length, places outside the part or in a gap
SurfaceRegion choose_places(const TrimmedModel& model, const PlaceChoice& choice, const std::string& what);

/// Position of a point choice. @throws InputError for a marker that the model lacks
Point3 position_of(const TrimmedModel& model, const PlaceChoice& choice, const std::string& what);

/// What the user should be warned of: what lines and points do to results, a choice that may be another one than meant.
/// @param subject  "support 'edge'"
std::vector<std::string> region_warnings(const RegionReport& report, const std::string& subject);

} // namespace iga::solve
