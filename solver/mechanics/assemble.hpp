// Stiffness, mass and body loads from the quadrature points of a model. Parallel; the same bits for any thread count.
#pragma once

#include "solver/mechanics/body_system.hpp"

#include <functional>

namespace iga::solve {

/// K_ij = ∫ B_iᵀ C B_j dV, by the model's points.
StiffnessMatrix assemble_stiffness(const SolutionSpace& space, const std::shared_ptr<const Connectivity>& connectivity,
                                   const ElasticMaterial& material);

/// The same of all bodies; blocks of different bodies stay zero.
StiffnessMatrix assemble_stiffness(const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity);

/// M_ij = ∫ ρ N_i N_j dV. Interior spans are integrated exactly whatever their rule: the reduced ones keep row sums,
/// not products of functions.
MassMatrix assemble_mass(const SolutionSpace& space, const std::shared_ptr<const Connectivity>& connectivity,
                         double density);

MassMatrix assemble_mass(const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity);

/// m_i = ∫ ρ N_i dV: the row sums of M without M. (num_nodes) An extension may take more mass from a node than it has:
/// see spare_masses.
Eigen::VectorXd lumped_mass(const SolutionSpace& space, double density);

/// The stiffness of one span, (3 n × 3 n) over nodes(a), lower triangle filled at least: for local eigenproblems, which
/// under generalised rules need an interior span's own Gauss points.
void span_stiffness(const SolutionSpace& space, std::int64_t a, const ElasticMaterial& material, SpanShapes& shapes,
                    Eigen::MatrixXd& block, InteriorPoints interior = InteriorPoints::Gauss);

/// Sum over the cells, in their order, of what each brings to its nodes; parallel, the same bits for any thread count.
/// (num_unknowns) @param nodal  of a cell: (3 × nodes(a).size()); called from several threads
Eigen::VectorXd sum_over_cells(const SolutionSpace& space, const std::function<Eigen::MatrixXd(std::int64_t)>& nodal);

/// f_i = ∫ N_i b dV for a body force b (force/length³). (num_unknowns)
Eigen::VectorXd body_force(const SolutionSpace& space, const Point3& b);

/// The same for a body force that depends on the position, by the model's points. (num_unknowns)
Eigen::VectorXd distributed_load(const SolutionSpace& space, const std::function<Point3(const Point3&)>& b);

} // namespace iga::solve
