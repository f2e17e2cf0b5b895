// Parts of the embedded surface chosen by name, number, place or direction: where supports and loads act.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <optional>
#include <string>

namespace iga::solve {

/// Which surface points a condition holds on: all given tests must be met; with none given, the whole surface.
struct RegionChoice {
  std::optional<std::string> name;    ///< region name in the file
  std::optional<std::int64_t> number; ///< region number in the file, from 0
  std::optional<Box3> box;            ///< position within a box (part's frame)
  struct Plane {
    Point3 point{}, normal{};
    double tolerance = 0; ///< length; never taken smaller than the depth by which surface points may be moved
  };
  std::optional<Plane> plane; ///< position on a plane
  struct Direction {
    Point3 direction{};
    double angle = 0; ///< degrees between the outward normal and the direction
  };
  std::optional<Direction> normal;
};

/// What a region turned out to be, for the report.
struct RegionReport {
  std::string name;
  std::int64_t points = 0;
  double area = 0;   ///< length²
  Point3 centroid{}; ///< length, the part's frame
};

/// The surface points of a choice, span by span. Pieces of surface are chosen point by point: where a box or an angle
/// cuts through a triangle, the border of the region is as fine as the surface's quadrature points.
struct SurfaceRegion {
  RegionReport report;
  std::vector<std::int64_t> spans;   ///< (m) active spans that own chosen points, ascending
  std::vector<std::int64_t> offsets; ///< (m + 1)
  std::vector<std::int64_t> points;  ///< rows of model.surface.quadrature, ascending
  std::span<const std::int64_t> points_of(std::size_t s) const {
    const auto first = static_cast<std::size_t>(offsets[s]);
    return {points.data() + first, static_cast<std::size_t>(offsets[s + 1]) - first};
  }
};

/// @param what  what the region is for, opens the message: "support 'base'"
/// @throws InputError for a choice without area, with what was asked for and the regions that exist
SurfaceRegion choose_region(const TrimmedModel& model, const RegionChoice& choice, const std::string& what);

/// Some points of one span, gathered so that shape functions can be evaluated at once.
struct PointBatch {
  std::int64_t span = 0;
  std::vector<double> parameters; ///< (n × 3), row-major
  std::vector<double> weights;    ///< (n); area, length²
  std::vector<Point3> normals;    ///< (n); outward, unit
  std::vector<Point3> positions;  ///< (n); length, the part's frame
  std::size_t size() const { return weights.size(); }
};
PointBatch gather(const TrimmedModel& model, const SurfaceRegion& region, std::size_t s);

} // namespace iga::solve
