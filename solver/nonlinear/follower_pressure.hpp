// Pressure that stays normal to the surface as it turns and stretches.
#pragma once

#include "solver/nonlinear/finite_body.hpp"
#include "solver/space/surface_region.hpp"

namespace iga::solve {

/// f_i = -p ∫ N_i cof(F) n₀ dA₀: the traction -p n on the area that the surface has now.
class FollowerPressure {
 public:
  /// @param region    of the undeformed surface
  /// @param pressure  force/length² of the deformed area, positive presses on the part
  FollowerPressure(const SolutionSpace& space, SurfaceRegion region, double pressure)
      : space_(&space), region_(std::move(region)), pressure_(pressure) {}

  /// f += factor · forces; their sum.
  Point3 add_forces(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& f) const;
  /// A -= factor · ∂(forces)/∂u: the load stiffness, symmetric where the surface is closed or its rim is held.
  void subtract_stiffness(const Eigen::VectorXd& u, double factor, Tangent& A) const;

 private:
  const SolutionSpace* space_;
  SurfaceRegion region_;
  double pressure_;
};

} // namespace iga::solve
