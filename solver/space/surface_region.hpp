// Parts of the embedded surface chosen by name, number, place or direction: where supports and loads act.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

/// Which part of the surface a condition holds on: all given tests must be met; with none given, the whole surface.
struct RegionChoice {
  std::vector<std::string> names;    ///< regions of the file by name …
  std::vector<std::int64_t> numbers; ///< … and by number, from 0; any of both will do
  std::optional<Box3> box;           ///< position within a box (part's frame)
  struct Plane {
    Point3 point{}, normal{};
    double tolerance = 0; ///< length
  };
  std::optional<Plane> plane; ///< position between the two planes at the tolerance to both sides
  struct Direction {
    Point3 direction{};
    double angle = 0; ///< degrees between the outward normal and the direction
  };
  std::optional<Direction> normal;
  struct Patch {
    std::filesystem::path file;      ///< STL
    std::optional<double> tolerance; ///< length; chosen from the facets where none is given
  };
  std::optional<Patch> patch; ///< position on an open piece of surface
};

enum class Extent { Surface, Line, Point };

/// What a region turned out to be, for the report.
struct RegionReport {
  std::string name;
  std::int64_t points = 0;
  double area = 0;       ///< length²; 0 of lines and points
  Point3 centroid{};     ///< length, the part's frame
  std::string body = {}; ///< that the region belongs to; empty where there is one
  Extent extent = Extent::Surface;
  double length = 0; ///< of lines
  double reach = 0;  ///< of lines and points: stress nearer than this is not to be read, two spans, length
  std::vector<Point3> places = {}; ///< quadrature points of lines and points, length, the part's frame
  std::string note = {};           ///< what was found and the user should see: a cylinder's radius, a patch's tolerance
  std::string warning = {};        ///< what may make the choice another one than was meant
};

/// Quadrature points of a choice, cell by cell. Triangles that lie in it as a whole bring the model's own points where
/// these are exact for products of functions; those that a box or a plane cuts get new ones on what is left of them:
/// area and centroid are exact. A corner that lies within the model's surface_depth of a plane counts as lying in it.
struct SurfaceRegion {
  RegionReport report;
  std::vector<std::int64_t> cells;     ///< (m) that own chosen points, ascending
  std::vector<std::int64_t> offsets;   ///< (m + 1)
  std::vector<double> parameters;      ///< (points × 3), row-major, knot space, inside the closed span of the cell
  std::vector<double> weights;         ///< (points); area, length²
  std::vector<Point3> normals;         ///< (points); outward, unit
  std::vector<std::int64_t> triangles; ///< of the model's surface that lie in it as a whole or in part, ascending
};

/// @param what  what the region is for, opens the message: "support 'base'"
/// @throws InputError for a choice without area, with what was asked for and the regions that exist
SurfaceRegion choose_region(const TrimmedModel& model, const RegionChoice& choice, const std::string& what);

/// What a choice leaves of one triangle of the surface.
struct ChosenPolygon {
  std::size_t triangle = 0;
  Point3 normal{};             ///< outward, unit
  std::vector<Point3> corners; ///< convex, anticlockwise seen from outside; length, the part's frame
};
/// The same choice as polygons, in the order of the triangles. Throws as choose_region.
std::vector<ChosenPolygon> choose_polygons(const TrimmedModel& model, const RegionChoice& choice,
                                           const std::string& what);

/// Some points of one cell, gathered so that shape functions can be evaluated at once.
struct PointBatch {
  std::int64_t cell = 0;
  std::vector<double> parameters; ///< (n × 3), row-major
  std::vector<double> weights;    ///< (n); area, length²
  std::vector<Point3> normals;    ///< (n); outward, unit
  std::vector<Point3> positions;  ///< (n); length, the part's frame
  std::size_t size() const { return weights.size(); }
};
PointBatch gather(const TrimmedModel& model, const SurfaceRegion& region, std::size_t s);

} // namespace iga::solve
