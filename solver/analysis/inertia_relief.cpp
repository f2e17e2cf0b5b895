#include "solver/analysis/inertia_relief.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/assemble.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace iga::solve {

namespace {

// σ over ω² of the part's size (lambda_scale): a step of refinement leaves σ / ω² of an elastic mode's error, 1e-2 in
// slender parts whose first mode lies at 1e-4 of that.
constexpr double sigma_share = 1e-6;

using Motion = Eigen::Matrix<double, 6, 1>; // acceleration of the centre, angular acceleration

} // namespace

InertiaRelief::InertiaRelief(const BodySystem& system, const StiffnessMatrix& K)
    : system_(&system), M_(assemble_mass(system, K.shared_connectivity())), bodies_(separate_bodies(K.pattern())),
      sigma_(sigma_share * lambda_scale(system)) {
  const auto points = system.node_points();
  const auto count = static_cast<std::size_t>(bodies_.count);
  plain_.resize(count);
  const auto body_of = [&](Eigen::Index node) {
    return static_cast<std::size_t>(bodies_.of_node[static_cast<std::size_t>(node)]);
  };
  for (const SystemBody& body : system)
    for (std::int64_t n = 0; n < body.space->num_nodes(); ++n) {
      auto& names = plain_[body_of(body.first_node + n)].bodies;
      if (system.size() > 1 && (names.empty() || names.back() != body.name)) names.push_back(body.name);
    }
  // First about the middle of each body's nodes, which gives the centre of mass, then about that.
  std::vector<Eigen::Vector3d> centre(count, Eigen::Vector3d::Zero());
  std::vector<double> nodes(count, 0);
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    centre[body_of(n)] += points.row(n).transpose();
    nodes[body_of(n)] += 1;
  }
  for (std::size_t b = 0; b < count; ++b) centre[b] /= nodes[b];
  for (const bool about_mass : {false, true}) {
    R_ = Eigen::MatrixXd::Zero(system.num_unknowns(), 6 * bodies_.count);
    for (Eigen::Index n = 0; n < points.rows(); ++n) {
      const Eigen::Vector3d r = points.row(n).transpose() - centre[body_of(n)];
      const auto first = 6 * static_cast<Eigen::Index>(body_of(n));
      for (Eigen::Index d = 0; d < 3; ++d) {
        R_(3 * n + d, first + d) = 1;
        R_.block<3, 1>(3 * n, first + 3 + d) = Eigen::Vector3d::Unit(d).cross(r);
      }
    }
    MR_.resize(R_.rows(), R_.cols());
    for (Eigen::Index c = 0; c < R_.cols(); ++c) MR_.col(c) = M_ * Eigen::VectorXd(R_.col(c));
    G_.clear();
    for (std::size_t b = 0; b < count; ++b) {
      const auto first = 6 * static_cast<Eigen::Index>(b);
      G_.emplace_back(R_.middleCols<6>(first).transpose() * MR_.middleCols<6>(first));
      plain_[b].mass = G_[b](0, 0);
      if (about_mass) continue;
      // ∫ ρ e_i · (e_j × r) = ε_ijk S_k with the first moments S.
      centre[b] += Eigen::Vector3d(G_[b](1, 5), G_[b](2, 3), G_[b](0, 4)) / G_[b](0, 0);
    }
  }
  for (std::size_t b = 0; b < count; ++b) plain_[b].centre = as_point(centre[b]);
}

std::vector<RigidAcceleration> InertiaRelief::accelerations(const Eigen::VectorXd& f) const {
  std::vector<RigidAcceleration> all = plain_;
  for (std::size_t b = 0; b < all.size(); ++b) {
    const Motion load = R_.middleCols<6>(6 * static_cast<Eigen::Index>(b)).transpose() * f;
    const Motion a = G_[b].fullPivLu().solve(load);
    all[b].acceleration = as_point(a.head<3>());
    all[b].angular = as_point(a.tail<3>());
    const Eigen::Vector3d force = -(G_[b] * a).head<3>(), about_centre = -(G_[b] * a).tail<3>();
    all[b].inertia_force = as_point(force);
    all[b].inertia_moment = as_point(about_centre + as_vector(all[b].centre).cross(force));
  }
  return all;
}

Eigen::VectorXd InertiaRelief::inertia(const std::vector<RigidAcceleration>& accelerations) const {
  Eigen::VectorXd a(R_.cols());
  for (std::size_t b = 0; b < accelerations.size(); ++b) {
    a.segment<3>(6 * static_cast<Eigen::Index>(b)) = as_vector(accelerations[b].acceleration);
    a.segment<3>(6 * static_cast<Eigen::Index>(b) + 3) = as_vector(accelerations[b].angular);
  }
  return MR_ * a;
}

std::optional<BodyForce> InertiaRelief::body_force(const std::vector<RigidAcceleration>& accelerations,
                                                   std::size_t body) const {
  const SystemBody& part = (*system_)[body];
  const auto first = bodies_.of_node.begin() + part.first_node;
  const auto last = first + part.space->num_nodes();
  if (std::any_of(first, last, [&](std::int32_t b) { return b != *first; })) return std::nullopt;
  const RigidAcceleration& a = accelerations[static_cast<std::size_t>(*first)];
  return [a, density = part.material.density](const Point3& x) {
    return times(plus(a.acceleration, cross(a.angular, minus(x, a.centre))), -density);
  };
}

Eigen::VectorXd InertiaRelief::without_rigid(const Eigen::VectorXd& u) const {
  Eigen::VectorXd rest = u;
  for (std::size_t b = 0; b < G_.size(); ++b) {
    const auto first = 6 * static_cast<Eigen::Index>(b);
    const Motion share = G_[b].fullPivLu().solve(Motion(MR_.middleCols<6>(first).transpose() * u));
    rest -= R_.middleCols<6>(first) * share;
  }
  return rest;
}

} // namespace iga::solve
