#include "solver/explicit/motion/node_update.hpp"

#include "solver/base/parallel.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index chunk = 1024; // nodes; what is read of them stays in the cache

template <class Visit> void for_nodes(Index nodes, Visit visit) {
  for_chunks(static_cast<std::size_t>(nodes), chunk, [&](std::size_t c, std::size_t first, std::size_t last) {
    visit(static_cast<Index>(c), static_cast<Index>(first), static_cast<Index>(last));
  });
}

void add(NodeSums& all, const NodeSums& part) {
  all.before.internal += part.before.internal;
  all.before.load += part.before.load;
  all.before.damping += part.before.damping;
  all.after.internal += part.after.internal;
  all.after.load += part.after.load;
  all.after.damping += part.after.damping;
  all.kinetic += part.kinetic;
  all.linear += part.linear;
  all.angular += part.angular;
  all.linear_impulse += part.linear_impulse;
  all.angular_impulse += part.angular_impulse;
  all.linear_scale += part.linear_scale;
  all.angular_scale += part.angular_scale;
}

void add_momentum(const Vector3d& x, const Vector3d& p, NodeSums& sums) {
  const Vector3d about_origin = x.cross(p);
  sums.linear += p;
  sums.angular += about_origin;
  sums.linear_scale += p.norm();
  sums.angular_scale += about_origin.norm();
}

// One body's step, node by node.
class Update {
 public:
  Update(const ExplicitBody& body, const NodeForces& forces)
      : body_(body), forces_(forces), weight_(body.weight().size() > 0), alpha_(body.settings().damping),
        is_first_(forces.dt_last == 0), h_((forces.dt_last + forces.dt_next) / 2),
        next_share_(forces.dt_next / (2 * h_)),
        difference_share_(is_first_ ? 0.5 : forces.dt_last * forces.dt_next / (8 * h_ * h_)) {}

  Vector3d load(Index n) const {
    Vector3d f = Vector3d::Zero();
    if (forces_.load) f += forces_.load->segment<3>(3 * n);
    if (weight_) f += body_.weight().segment<3>(3 * n);
    return f;
  }
  Vector3d penalty(Index n) const {
    return forces_.penalty ? Vector3d(forces_.penalty->segment<3>(3 * n)) : Vector3d::Zero();
  }
  Vector3d next_momentum(Index n, const Vector3d& external) const {
    const Vector3d p = body_.momentum.segment<3>(3 * n), f = external - body_.internal.segment<3>(3 * n);
    if (is_first_) return p + h_ * (f - alpha_ * p);
    return ((1 - alpha_ * h_ / 2) * p + h_ * f) / (1 + alpha_ * h_ / 2);
  }
  double gain() const { return is_first_ ? h_ : h_ / (1 + alpha_ * h_ / 2); }
  void count(Index n, const Vector3d& f_load, const Vector3d& f_penalty, const Vector3d& p, const Vector3d& v,
             NodeSums& sums) const {
    const Vector3d p_last = body_.momentum.segment<3>(3 * n), v_last = body_.velocity.segment<3>(3 * n);
    const Vector3d f_damping = is_first_ ? Vector3d(-alpha_ * p_last) : Vector3d(-alpha_ * (p_last + p) / 2);
    const Vector3d f_internal = body_.internal.segment<3>(3 * n);
    const Vector3d x = body_.node_points().row(n).transpose() + body_.displacement.segment<3>(3 * n);
    sums.before.internal += f_internal.dot(v_last);
    sums.before.load += f_load.dot(v_last);
    sums.before.damping -= f_damping.dot(v_last);
    sums.after.internal += f_internal.dot(v);
    sums.after.load += f_load.dot(v);
    sums.after.damping -= f_damping.dot(v);
    const Vector3d p_now = is_first_ ? p_last : Vector3d(next_share_ * p_last + (1 - next_share_) * p);
    const Vector3d v_now = is_first_ ? v_last : Vector3d(next_share_ * v_last + (1 - next_share_) * v);
    sums.kinetic += 0.5 * p_now.dot(v_now) - difference_share_ * (p - p_last).dot(v - v_last);
    add_momentum(x, p, sums);
    const Vector3d impulse = h_ * (f_load + f_penalty + f_damping);
    sums.linear_impulse += impulse;
    sums.angular_impulse += x.cross(impulse);
  }

 private:
  const ExplicitBody& body_;
  const NodeForces& forces_;
  const bool weight_;
  const double alpha_;
  const bool is_first_;
  const double h_;
  const double next_share_;       // of what was before t_n in what is at t_n, by linear interpolation
  const double difference_share_; // dt_last dt_next / 8 in units of h²
};

} // namespace

NodeSums update_momentum(ExplicitBody& body, const NodeForces& forces) {
  const Update update(body, forces);
  const Index nodes = body.space().num_nodes();
  std::vector<NodeSums> parts(static_cast<std::size_t>((nodes + chunk - 1) / chunk));
  if (body.mass().is_lumped()) {
    for_nodes(nodes, [&](Index c, Index first, Index last) {
      NodeSums sums;
      for (Index n = first; n < last; ++n) {
        const Vector3d load = update.load(n), penalty = update.penalty(n);
        const Vector3d p = update.next_momentum(n, load + penalty), v = body.inverse_mass()[n] * p;
        update.count(n, load, penalty, p, v, sums);
        body.momentum.segment<3>(3 * n) = p;
        body.velocity.segment<3>(3 * n) = v;
      }
      parts[static_cast<std::size_t>(c)] = sums;
    });
  } else {
    VectorXd p(body.num_unknowns()), v(body.num_unknowns());
    for_nodes(nodes, [&](Index, Index first, Index last) {
      for (Index n = first; n < last; ++n)
        p.segment<3>(3 * n) = update.next_momentum(n, update.load(n) + update.penalty(n));
    });
    body.mass().divide(p.data(), v.data(), 1);
    for_nodes(nodes, [&](Index c, Index first, Index last) {
      NodeSums sums;
      for (Index n = first; n < last; ++n)
        update.count(n, update.load(n), update.penalty(n), p.segment<3>(3 * n), v.segment<3>(3 * n), sums);
      parts[static_cast<std::size_t>(c)] = sums;
    });
    body.momentum = std::move(p);
    body.velocity = std::move(v);
  }
  NodeSums all;
  for (const NodeSums& part : parts) add(all, part);
  return all;
}

double next_velocity(const ExplicitBody& body, const NodeForces& forces, VectorXd& velocity) {
  const Update update(body, forces);
  VectorXd p(body.num_unknowns());
  velocity.resize(body.num_unknowns());
  for_nodes(body.space().num_nodes(), [&](Index, Index first, Index last) {
    for (Index n = first; n < last; ++n)
      p.segment<3>(3 * n) = update.next_momentum(n, update.load(n) + update.penalty(n));
  });
  body.mass().divide(p.data(), velocity.data(), 1);
  return update.gain();
}

void update_displacement(ExplicitBody& body, double dt) {
  for_nodes(body.space().num_nodes(), [&](Index, Index first, Index last) {
    body.displacement.segment(3 * first, 3 * (last - first)) +=
        dt * body.velocity.segment(3 * first, 3 * (last - first));
  });
}

NodeSums momentum_of(const ExplicitBody& body) {
  NodeSums sums;
  for (Index n = 0; n < body.node_points().rows(); ++n) {
    const Vector3d x = body.node_points().row(n).transpose() + body.displacement.segment<3>(3 * n);
    const Vector3d p = body.momentum.segment<3>(3 * n);
    add_momentum(x, p, sums);
  }
  return sums;
}

} // namespace iga::solve
