// Estimated errors of the fields of an analysis, from what they leave of the equations.
#pragma once

#include "solver/analysis/bound_system.hpp"
#include "solver/estimate/residual_estimate.hpp"
#include "solver/mechanics/loads.hpp"

namespace iga::solve {

/// What loads do to one body.
struct BodyLoads {
  BodyForce body_force;              ///< force/length³, a polynomial of the splines' degree at most; empty: none
  std::vector<SurfaceLoad> surfaces; ///< of known traction
  std::vector<SurfaceLoad> rigid;    ///< of a rigid motion; their traction is the field's own
};

/// Estimated a(e, e) of fields on a system, by body: (num_cells × k); see residual_energy. On supports and ties the
/// traction along the fixed directions is the field's own: they add no residual.
/// @param unknowns  (num_unknowns × k)
/// @param lambda    (k), ω² of modes
/// @param loads     by body; none: no body is loaded
/// @pre no_field_errors(system) is empty
std::vector<Eigen::MatrixXd> field_errors(const BodySystem& system, const BoundSystem& bound,
                                          const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                                          const Eigen::VectorXd& lambda, std::span<const BodyLoads> loads = {});

/// Sums of the same over all cells: (k).
Eigen::VectorXd total_errors(std::span<const Eigen::MatrixXd> errors);

/// Why errors cannot be estimated from the fields; empty where they can.
std::string no_field_errors(const BodySystem& system);

} // namespace iga::solve
