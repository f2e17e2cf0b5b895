// Loads of a static analysis: body forces, those of turning parts, tractions, pressure, forces and moments on regions,
// forces along lines and at points.
#pragma once

#include "solver/space/places.hpp"
#include "solver/space/solution_space.hpp"
#include "solver/space/surface_region.hpp"

#include <functional>

namespace iga::solve {

enum class LoadKind {
  BodyForce,    ///< vector: force/length³ everywhere in the part
  Acceleration, ///< vector: length/time²; body force density · vector (gravity)
  Centrifugal,  ///< spin: what its own inertia does to a part that turns about an axis
  Traction,     ///< vector: force/length² on a region
  Pressure,     ///< pressure p: traction -p n on a region
  TotalForce,   ///< vector: force, spread evenly over a region
  Remote,       ///< vector and moment: force and moment on a region, the force acting at `remote`
  Bearing,      ///< vector: force of a pin in a bore, or of a bore on a shaft
  Line,         ///< vector: force, spread evenly along a line
  Point,        ///< vector: force at a point
};
const char* name_of(LoadKind kind);
/// Does a load of this kind act on all of the part, not on a choice of surface, a line or a point?
bool acts_on_volume(LoadKind kind);

/// A part that turns about a fixed axis, seen from the part itself: body force ρ (ω² r - α × r), with r from the axis.
struct Spin {
  Point3 axis{0, 0, 1};      ///< unit, in the load's frame
  Point3 point{};            ///< on the axis, length, the part's frame
  double speed = 0;          ///< ω, radians/time
  std::optional<double> rpm; ///< instead: turns per minute, until speed_of_rpm gives ω
  double acceleration = 0;   ///< α about the axis, radians/time²
};

struct Load {
  std::string name;
  std::string body; ///< that it acts on; empty: the only one that has such a surface or place, body forces: all
  LoadKind kind = LoadKind::Traction;
  RegionChoice region;
  PlaceChoice place;            ///< of Line and Point
  Point3 vector{};              ///< in `frame`
  double pressure = 0;          ///< force/length², positive presses on the part
  Point3 moment{};              ///< force · length, in `frame`
  std::optional<Point3> remote; ///< length, the part's frame; without it the force acts at the region's centroid
  Spin spin;                    ///< of Centrifugal
  bool rigid = false;           ///< the region moves as a rigid body (static analyses)
  Rotation frame = identity_rotation;
};

/// What a load turned out to be.
struct LoadReport {
  std::string name;
  RegionReport region; ///< no points where the load acts on no region
  Point3 force{};      ///< resultant, the part's frame
  Point3 moment{};     ///< about the origin
};
/// Warnings about what loads act on.
std::vector<std::string> region_warnings(std::span<const LoadReport> loads);

/// Traction (force/length²) at a position with an outward unit normal.
using TractionField = std::function<Point3(const Point3& position, const Point3& normal)>;

/// A load on surface, a line or a point: where, and as traction (on a line force/length, at a point force).
struct SurfaceLoad {
  SurfaceRegion region;
  TractionField traction;
};

struct LoadTerms {
  Eigen::VectorXd load; ///< (num_unknowns)
  std::vector<LoadReport> reports;
  std::vector<SurfaceLoad> surfaces; ///< by load; without points where it acts on the volume
};

/// @throws InputError for a region without area or a point outside the part, naming the load
LoadTerms assemble_loads(const SolutionSpace& space, double density, std::span<const Load> loads);

/// Force/length³ at a position.
using BodyForce = std::function<Point3(const Point3& position)>;
/// That of a load that acts on the volume, none of others. It is constant or, for Centrifugal, linear.
/// @pre the speed is known: spin.rpm is resolved
std::optional<BodyForce> volume_force(const Load& load, double density);

/// f_i = ∫ N_i t dA over a region; the report gets its resultants. (num_unknowns)
Eigen::VectorXd traction_load(const SolutionSpace& space, const SurfaceRegion& region, const TractionField& traction,
                              LoadReport& report);

} // namespace iga::solve
