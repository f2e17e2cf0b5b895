// What modal superposition works in: modes, and residual vectors that make up for the modes that are left out.
#pragma once

#include "solver/analysis/eigen_solver.hpp"
#include "solver/analysis/response_settings.hpp"

namespace iga::solve {

/// Vectors with Vᵀ M V = I and Vᵀ K V = diag(lambda): rigid modes, elastic modes, residual vectors.
struct ModalBasis {
  Eigen::MatrixXd vectors; ///< (num_unknowns × size)
  Eigen::VectorXd lambda;  ///< (size): ω², of rigid modes 0; of residual vectors their pseudo-frequency's
  Eigen::Index rigid = 0, elastic = 0, residual = 0;

  Eigen::Index size() const { return lambda.size(); }
  Eigen::Index modes() const { return rigid + elastic; }
  double omega(Eigen::Index j) const { return std::sqrt(lambda[j]); }
  /// Highest frequency of a mode, cycles/time; 0 without elastic ones.
  double highest_frequency() const;
};

/// The modes alone. @throws NumericalError where a mechanism is among them
ModalBasis modal_basis(const ModeSet& modes);

/// Adds residual vectors of the loads (num_unknowns × loads): what is left of each static solution, R = K⁻¹ f - Σ φ φᵀ
/// f / ω², made M-orthonormal and independent; on parts that are not held, of the load less the inertia forces of its
/// rigid motion. So statics and what varies slowly against the modes left out are exact whatever the number of modes.
/// (Dickens, Nakagawa, Wittbrodt 1997, A critique of mode acceleration and modal truncation augmentation methods.)
/// @param[out] share  (loads): share of the modes in each static solution's strain energy, 0 … 1; 1 for no load
/// @pre no constraints
/// @throws NumericalError where a static solution leaves more than 1e-8 of its load
void add_residual_vectors(const EigenProblem& problem, const Eigen::MatrixXd& loads, ModalBasis& basis,
                          Eigen::VectorXd& share);

/// Damping of each vector of a basis: q̈ + c q̇ + ω² (1 + i η) q = p.
struct ModalDamping {
  Eigen::VectorXd c;     ///< (size), 1/time
  double structural = 0; ///< η
};
ModalDamping modal_damping(const DampingSettings& settings, const ModalBasis& basis);
/// The share of critical damping that vector j has at its own frequency, structural damping as η / 2.
double damping_ratio(const ModalDamping& damping, const ModalBasis& basis, Eigen::Index j);

} // namespace iga::solve
