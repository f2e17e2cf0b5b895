// What a loaded state adds to the stiffness: the work of its stress on the turning of fibres, and what the centrifugal
// force gains where the part moves away from its axis.
#pragma once

#include "solver/mechanics/body_system.hpp"

namespace iga::solve {

/// K_G,ij = ∫ ∇N_i · σ ∇N_j dV, alike for the three components, by the model's own points: the second variation of
/// ∫ σ : ½ ∇uᵀ∇u dV. Material that fills thin parts up (fictitious_share) carries no stress.
/// @param stress  by body: (num_points × 6) at its model's quadrature points, xx yy zz xy yz zx; force/length²
MassMatrix assemble_geometric_stiffness(const BodySystem& system,
                                        const std::shared_ptr<const Connectivity>& connectivity,
                                        std::span<const std::span<const double>> stress);

/// K_ij += A_ij P for the nodes i, j of some bodies: a matrix over the nodes as one over the unknowns, with P (3 × 3,
/// symmetric) for what it does to the components.
/// @pre both matrices have the same connectivity
/// @param first_node, end_node  of the bodies; A couples no body with another one
void add_blocks(const MassMatrix& A, const Eigen::Matrix3d& P, StiffnessMatrix& K, std::int64_t first_node,
                std::int64_t end_node);

/// K += factor L. @pre the same connectivity
void add_scaled(const StiffnessMatrix& L, double factor, StiffnessMatrix& K);

} // namespace iga::solve
