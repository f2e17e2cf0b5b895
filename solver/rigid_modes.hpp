// Rigid motions are known before any eigenvalue is computed: they are written down, checked and kept out of the search.
#pragma once

#include "solver/free_motions.hpp"
#include "solver/mass_operator.hpp"

namespace iga::solve {

/// Six columns per body: translations along and rotations about the axes through the middle of its nodes.
/// (num_unknowns × 6 bodies)
Eigen::MatrixXd rigid_motions(const SolutionSpace& space, const Bodies& bodies);

/// ω² of the size of a part's first elastic ones: (π c / L)², slowest wave over the diagonal of its nodes' box.
double lambda_scale(const SolutionSpace& space, const ElasticMaterial& material);

/// Combinations of `motions` that are free: no stiffness resists them and no constraint forbids them.
struct FreeMotions {
  Eigen::MatrixXd vectors;      ///< (num_unknowns × free), M-orthonormal
  Eigen::MatrixXd mass_vectors; ///< M times these
  Eigen::VectorXd lambda;       ///< (free): Rayleigh quotients vᵀ K v, rounding only
};
/// @param lambda_scale   ω² that counts as large for the part: (π c / L)²
FreeMotions free_motions(const StiffnessMatrix& K, const MassOperator& M, const ConstraintMatrix* constraints,
                         const Eigen::MatrixXd& motions, double lambda_scale);

} // namespace iga::solve
