// How a region of surface moves on average: as a rigid body, whatever it does beside that.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/space/surface_region.hpp"

namespace iga::solve {

/// The rigid motion nearest to the displacement on a region, in the mean square over its area.
/// (6 × num_unknowns of the system): velocity at the region's centroid, then angular velocity (radians).
RowMatrix average_motion(const BodySystem& system, std::size_t body, const SurfaceRegion& region);

/// Mean displacement over a region, along lines, or that of a point. (3 × num_unknowns of the system)
RowMatrix mean_displacement(const BodySystem& system, std::size_t body, const SurfaceRegion& region);

/// [r]×: r × v as a matrix.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r);
/// (6 × 6): motion at a place (its displacement, the same rotation) from that at the centroid.
Eigen::Matrix<double, 6, 6> moved_to(const Point3& place, const Point3& centroid);

} // namespace iga::solve
