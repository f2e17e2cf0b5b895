// Rigid motions are known before any eigenvalue is computed: they are written down, checked and kept out of the search.
#pragma once

#include "solver/mechanics/mass_operator.hpp"

namespace iga::solve {

/// Number of mechanically separate bodies and the body of each node: nodes that share a span or are tied are connected.
struct Bodies {
  std::int64_t count = 0;
  std::vector<std::int32_t> of_node; ///< (num_nodes), numbered by their first node
};
Bodies separate_bodies(const NodePattern& pattern);
Bodies separate_bodies(const SolutionSpace& space);

/// Six columns per body: translations along and rotations about the axes through the middle of its nodes.
/// (num_unknowns × 6 bodies)
Eigen::MatrixXd rigid_motions(const BodySystem& system, const Bodies& bodies);
/// The six of all bodies moving as one: rotations are about the axes through `centre`. (num_unknowns × 6)
Eigen::MatrixXd rigid_motions(const BodySystem& system, const Point3& centre);

/// ω² of the size of a part's first elastic ones: (π c / L)², slowest wave of all bodies over the diagonal of their
/// nodes' box.
double lambda_scale(const BodySystem& system);

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
