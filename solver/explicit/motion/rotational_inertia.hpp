// How a body resists turning: what its mass matrix gives beside what its quadrature points give. Row sums keep mass and
// centre of mass, but move mass outwards: a lumped body of few spans turns too slowly.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/explicit/motion/explicit_body.hpp"

#include <Eigen/Core>

namespace iga::solve {

/// Centre of mass of the quadrature points, length.
Point3 centre_of_mass(const TrimmedModel& model);

/// ∫ ρ (|r|² I - r rᵀ) dV about `centre` by the quadrature points, mass · length².
Eigen::Matrix3d inertia_of_points(const TrimmedModel& model, double density, const Point3& centre);

/// The same of a mass matrix: entry (i, j) is a_iᵀ M a_j with the nodal velocities a_i of a turn with speed 1 about
/// axis i. @param points  Greville points of the nodes, (num_nodes × 3)
Eigen::Matrix3d inertia_of_mass(const MassOperator& mass,
                                const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& points,
                                const Point3& centre);

/// Relative error of the inertia about `axis`; about the axis where it is largest for an axis of zero.
/// @pre exact is positive definite
double inertia_error(const Eigen::Matrix3d& found, const Eigen::Matrix3d& exact, const Point3& axis);

/// A warning where the lumped mass of a body makes its inertia wrong by more than two percent, with what the two-pass
/// mass gives. @param spin  at the start; zero where it does not turn yet
std::optional<std::string> inertia_warning(const ExplicitBody& body, const Point3& spin);

} // namespace iga::solve
