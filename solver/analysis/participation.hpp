// How much of the mass each mode moves: participation factors and effective masses.
#pragma once

#include "solver/mechanics/mass_operator.hpp"

namespace iga::solve {

/// Participation of modes in the six rigid motions r of the whole system: translations along x, y, z, rotations about
/// the axes along x, y, z through its centre of mass.
struct Participation {
  Point3 centre{}; ///< of mass, length
  /// rᵀ M r: the mass three times, then the moments of inertia about the centre; mass, mass · length²
  Eigen::Matrix<double, 6, 1> total = Eigen::Matrix<double, 6, 1>::Zero();
  /// (modes × 6): Γ = φᵀ M r for φᵀ M φ = 1; mass^(1/2), mass^(1/2) · length
  Eigen::Matrix<double, Eigen::Dynamic, 6> factors;

  /// (modes × 6): Γ², which over all modes sum up to the total.
  Eigen::MatrixXd effective_masses() const { return factors.cwiseAbs2(); }
  /// (modes × 6): effective masses of a mode and all before it, as shares of the total (0 where that is 0).
  Eigen::MatrixXd summed_shares() const;
};

/// @param modes  (num_unknowns × modes), φᵀ M φ = 1; those of several bodies together
Participation participation(const BodySystem& system, const MassOperator& M, const Eigen::MatrixXd& modes);

} // namespace iga::solve
