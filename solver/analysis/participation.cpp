#include "solver/analysis/participation.hpp"

#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/rigid_modes.hpp"

namespace iga::solve {

Eigen::MatrixXd Participation::summed_shares() const {
  Eigen::MatrixXd sums = effective_masses();
  for (Eigen::Index k = 1; k < sums.rows(); ++k) sums.row(k) += sums.row(k - 1);
  const auto inverse = total.unaryExpr([](double all) { return all > 0 ? 1 / all : 0.0; });
  return sums * inverse.asDiagonal();
}

Participation participation(const BodySystem& system, const MassOperator& M, const Eigen::MatrixXd& modes) {
  // The mass itself says where its centre is: a rotation about x moves it by ω × (centre - middle).
  const Eigen::Vector3d middle = system.node_points().colwise().mean();
  const Eigen::MatrixXd about_middle = rigid_motions(system, as_point(middle));
  const Eigen::MatrixXd inertia = about_middle.transpose() * columns_of(M, about_middle);
  Participation found;
  found.centre = as_point(middle + Eigen::Vector3d(inertia(1, 5), inertia(2, 3), inertia(0, 4)) / inertia(0, 0));
  const Eigen::MatrixXd motions = rigid_motions(system, found.centre), forces = columns_of(M, motions);
  found.total = motions.cwiseProduct(forces).colwise().sum().transpose();
  found.factors = modes.transpose() * forces;
  return found;
}

} // namespace iga::solve
