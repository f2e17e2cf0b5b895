// Normal and frictional forces of the touches, their energies, and the way back to the nodes.
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/explicit/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

constexpr std::size_t grain = 64;

double coefficient(const FrictionLaw& law, double speed, bool slides) {
  if (law.decay > 0)
    return law.dynamic_coefficient + (law.static_coefficient - law.dynamic_coefficient) * std::exp(-law.decay * speed);
  return slides ? law.dynamic_coefficient : law.static_coefficient;
}

/// c = 2 ξ √(k m) with m = k dt² / η.
double damping_of(const ContactPair& pair, double k, double dt) {
  return pair.stiffness > 0 ? 2 * pair.damping / std::sqrt(pair.stiffness) * k * dt : 0;
}

} // namespace

Point3 ContactModel::friction(const Touch& touch, const Spring& spring, const ContactPair& pair, double normal_force,
                              const StepTimes& times, Memory& memory) {
  const double k = spring.stiffness * spring.scale;
  if (k <= 0) return memory.traction = {};
  const Point3 sliding = minus(spring.velocity, iga::times(touch.normal, dot(spring.velocity, touch.normal)));
  const double mu = coefficient(pair.friction, norm(sliding), memory.sliding > 0), limit = mu * normal_force;
  // The stored force follows the surface: turned into the tangent plane at its length.
  const double before = norm(memory.traction);
  Point3 elastic = minus(memory.traction, iga::times(touch.normal, dot(memory.traction, touch.normal)));
  if (const double left = norm(elastic); left > 0) elastic = iga::times(elastic, before / left);
  elastic = minus(elastic, iga::times(sliding, k * times.dt_last));
  const double c = damping_of(pair, k, times.dt), trial = norm(elastic);
  const Point3 total = minus(elastic, iga::times(sliding, c));
  const double size = norm(total);
  memory.sliding = size > limit ? 1 : 0;
  if (size <= limit) {
    report_.energy.damping += c * dot(sliding, sliding) * times.dt_last;
    memory.traction = elastic;
    return total;
  }
  report_.energy.friction += 0.5 * (std::min(before, trial) + limit) * std::max(0.0, trial - limit) / k;
  return memory.traction = iga::times(total, limit / size);
}

void ContactModel::apply_forces(const StepTimes& times) {
  for (PairForce& pair : report_.pairs) pair = {pair.name, {}, 0, 0, 0, {}, 0, 0, pair.span_size};
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    const Spring& spring = springs_[c];
    const ContactPair& settings = searches_[pair_of_[c]].pair();
    Memory& memory = memory_[c];
    const double k = spring.stiffness * spring.scale, depth = touch.depth - memory.baseline;
    const double opening = dot(spring.velocity, touch.normal);
    memory.spring.take_over(k, spring.potential);
    const double elastic = k * memory.spring.move_to(elastic_depth(c), k, spring.potential).force;
    double normal_force = elastic;
    if (elastic > 0 && settings.damping > 0)
      normal_force = std::max(0.0, elastic - damping_of(settings, k, times.dt) * opening);
    report_.energy.damping -= (normal_force - elastic) * opening * times.dt_last;
    const Point3 tangential = friction(touch, spring, settings, normal_force, times, memory);
    const Point3 force = plus(iga::times(touch.normal, normal_force), tangential);
    for (int i = 0; i < touch.count; ++i) {
      const Touch::Entry& e = touch.entries[at(i)];
      Point3& sum = vertex_force_[e.surface][at(e.vertex)];
      sum = plus(sum, iga::times(force, e.weight));
    }
    if (touch.rigid >= 0) rigid_[at(touch.rigid)].add_force(iga::times(force, touch.rigid_sign), touch.point);
    PairForce& pair = report_.pairs[pair_of_[c]];
    pair.force = plus(pair.force, iga::times(force, touch.first_sign));
    pair.normal_force += normal_force;
    pair.friction_force += norm(tangential);
    if (depth > pair.largest_depth) {
      pair.largest_depth = depth;
      pair.deepest = touch.point;
    }
    if (depth > pair.forceless_depth && !(k > 0) && touch.area > 0 && settings.stiffness > 0) {
      pair.forceless_depth = depth;
      pair.forceless = touch.point;
    }
    if (const double share = depth / touch.wall; share > pair.wall_share) {
      pair.wall_share = share;
      pair.wall_depth = depth;
      pair.in_wall = touch.point;
    }
    pair.area += touch.area;
    ++pair.touches;
  }
}

void ContactModel::hand_back(std::span<const BodyState> bodies, const StepTimes& times) {
  double work = 0; // of the contact forces on all bodies, trapezoidal
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    const SparseRows& T = surface.active_columns();
    Eigen::VectorXd& force = force_[surface.owner()];
    force.setZero();
    auto& at_vertices = vertex_force_[s];
    const auto& nodes = surface.active_nodes();
    if (!touches_.empty())
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), grain), [&](const auto& range) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          const std::size_t i = at(nodes[k]);
          Point3 sum{};
          for (auto e = at(T.first[i]); e < at(T.first[i + 1]); ++e)
            sum = plus(sum, iga::times(at_vertices[at(T.column[e])], T.value[e]));
          for (std::size_t d = 0; d < 3; ++d) force[static_cast<Eigen::Index>(3 * i + d)] = sum[d];
        }
      });
    std::fill(at_vertices.begin(), at_vertices.end(), Point3{});
    const BodyState& body = bodies[surface.owner()];
    *body.force += force;
    Eigen::VectorXd& last = last_force_[surface.owner()];
    work += 0.5 * times.dt_last * (force + last).dot(*body.velocity);
    last.swap(force);
  }
  if (times.dt_last > 0)
    for (const RigidState& body : rigid_) work += body.work_of_forces();
  report_.energy.stored = -work - report_.energy.friction - report_.energy.damping;
}

} // namespace iga::solve
