// Tractions on a region with given resultants: a force and a moment spread evenly, the pressure of a pin in its bore.
#pragma once

#include "solver/mechanics/loads.hpp"
#include "solver/space/cylinder.hpp"

namespace iga::solve {

/// Second moment of a region about its centroid, ∫ (|r|² I - r rᵀ) dA (length⁴): what turns a moment into tractions.
Eigen::Matrix3d turning_inertia(const TrimmedModel& model, const SurfaceRegion& region);

/// t = a + b × r with r from the region's centroid: of all tractions with these resultants the one of least ∫ |t|² dA.
/// @param moment  about the centroid, force · length
TractionField spread_evenly(const TrimmedModel& model, const SurfaceRegion& region, const Point3& force,
                            const Point3& moment);

/// Pressure p cos φ on the half of a bore (or shaft) that the force presses, φ the angle from its direction; what acts
/// along the axis, by rounding of what was typed, is spread evenly. The resultant is the force to rounding.
/// @param what  opens the message: "load 'pin'"
/// @throws InputError for a force with more than 1 % along the axis, and where nothing of the pressed half is there
TractionField bearing_pressure(const TrimmedModel& model, const SurfaceRegion& region, const Cylinder& cylinder,
                               const Point3& force, const std::string& what);

} // namespace iga::solve
