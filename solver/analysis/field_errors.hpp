// Estimated errors of the fields of an analysis, from what they leave of the equations.
#pragma once

#include "solver/analysis/bound_system.hpp"
#include "solver/estimate/residual_estimate.hpp"

namespace iga::solve {

/// What loads do to one body.
struct BodyLoads {
  Eigen::Vector3d body_force = Eigen::Vector3d::Zero(); ///< force/length³
  std::vector<LoadedRegion> regions;
};
/// Traction of a region whose motion, not whose traction is prescribed.
Eigen::Vector3d its_own(const Point3& position, const Point3& normal, const Eigen::Vector3d& own);

/// Estimated a(e, e) of fields on a system, by body: (num_cells × k); see residual_energy. On supports and ties the
/// traction along the fixed directions is the field's own: they add no residual.
/// @param unknowns  (num_unknowns × k)
/// @param lambda    (k), ω² of modes
/// @param loads     by body; none: no body is loaded
/// @pre can_estimate(system)
std::vector<Eigen::MatrixXd> field_errors(const BodySystem& system, const BoundSystem& bound,
                                          const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                                          const Eigen::VectorXd& lambda, std::vector<BodyLoads> loads = {});

/// Sums of the same over all cells: (k).
Eigen::VectorXd total_errors(std::span<const Eigen::MatrixXd> errors);

/// Can errors be estimated from the fields? Not at p = 1, where the residual lies on the faces of the spans.
bool can_estimate(const BodySystem& system);

} // namespace iga::solve
