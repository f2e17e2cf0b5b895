// How far a computed field is from the solution, told from the field itself: what it leaves of the equations, cell by
// cell, and the energy of the correction that would take it up.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/space/surface_region.hpp"

#include <functional>

namespace iga::solve {

/// Traction (force/length²) that a surface point bears, from the field's own traction σ n there.
using BorneTraction =
    std::function<Eigen::Vector3d(const Point3& position, const Point3& normal, const Eigen::Vector3d& own)>;

/// Surface that is not free of traction.
struct LoadedRegion {
  const SurfaceRegion* region = nullptr;
  BorneTraction traction;
};

/// Fields of one body that are to fulfil div σ(u) + λ ρ u + b = 0 inside and σ n = t on the surface. A smooth initial
/// strain of the material is known to σ.
struct ResidualProblem {
  const SolutionSpace* space = nullptr;
  const ElasticMaterial* material = nullptr;
  Eigen::MatrixXd unknowns; ///< (space->num_unknowns() × k)
  Eigen::VectorXd lambda;   ///< (k), 1/time²; ω² of modes, 0 in statics
  /// force/length³ at a position; a polynomial of the grid's degree in each direction at most. Empty: none.
  std::function<Point3(const Point3&)> body_force;
  std::vector<LoadedRegion> loaded; ///< elsewhere t = 0
};

/// Estimated a(e, e) of the error e = u - u_h, by cell: (num_cells × k), force · length. Of modes with xᵀ M x = 1 their
/// sum is the estimated error of ω².
///
/// In every cell the residual r(w) = ∫ (div σ + λ ρ u + b) · w dV - ∫ (σ n - t) · w dA is taken with the functions
/// w = B_n(ξ_d) e_k, n = p_d + 1 and p_d + 2, d, k = 1 … 3 (Oscillation), and rᵀ A⁻¹ r summed with their energies A. On
/// whole spans A is block diagonal and the sum is, to leading order, the energy of the error of smooth fields. In
/// trimmed cells A counts the share of the span that is filled, at least `least_share`: functions reach into the
/// neighbours. After the residual-based estimate in enriched spaces of Coradello, Antolin, Vázquez, Buffa (2020).
/// Beside the ends of gaps, where fields are continuous only, half the jump of the traction between two cells counts
/// for either. Singular fields at sharp re-entrant edges have two to four times the error that is found. The volume's
/// part is taken in strong form: points that are exact for low degrees only do for it, since the residual is small
/// everywhere, and linear fields have none.
Eigen::MatrixXd residual_energy(const ResidualProblem& problem);

} // namespace iga::solve
