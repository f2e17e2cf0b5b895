// The largest eigenfrequency of K x = ω² M x, which limits the explicit time step.
#pragma once

#include "solver/mechanics/mass_operator.hpp"

namespace iga::solve {

struct LargestEigenvalue {
  double omega = 0;          ///< angular frequency, 1/time; from below
  double residual = 0;       ///< ‖K x - ω² M x‖ in the norm of M⁻¹, over ω² ‖x‖ in that of M
  std::int64_t products = 0; ///< with K
  Eigen::VectorXd mode;      ///< (num_unknowns), xᵀ M x = 1
};

/// On ω_max of a time step: Lanczos comes from below and stops there at 1e-3; ten times that is safe.
constexpr double omega_safety = 1.01;

/// @param tolerance  relative change and error of ω at which the iteration ends: 1e-8 for reports, 1e-3 for time steps
/// @throws NumericalError where it does not converge
LargestEigenvalue largest_eigenvalue(const StiffnessMatrix& K, const MassOperator& M, double tolerance);

} // namespace iga::solve
