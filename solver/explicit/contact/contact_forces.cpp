// Normal and frictional forces of the touches, their energies, and the way back to the nodes.
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"
#include "solver/explicit/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

constexpr std::size_t grain = 64; // touches or vertices that one thread works on
constexpr std::size_t nodes_of_piece = 256;

double coefficient(const FrictionLaw& law, double speed, bool slides) {
  if (law.decay > 0)
    return law.dynamic_coefficient + (law.static_coefficient - law.dynamic_coefficient) * std::exp(-law.decay * speed);
  return slides ? law.dynamic_coefficient : law.static_coefficient;
}

/// c = 2 ξ √(k m) with m = k dt² / η.
double damping_of(const ContactPair& pair, double k, double dt) {
  return pair.stiffness > 0 ? 2 * pair.damping / std::sqrt(pair.stiffness) * k * dt : 0;
}

void add_largest(double value, const Point3& place, double& largest, Point3& where) {
  if (value <= largest) return;
  largest = value;
  where = place;
}

template <class Sums> void add(const Sums& part, PairForce& all) {
  all.force = plus(all.force, part.force);
  all.normal_force += part.normal_force;
  all.friction_force += part.friction_force;
  all.area += part.area;
  all.touches += part.touches;
  add_largest(part.largest_depth, part.deepest, all.largest_depth, all.deepest);
  add_largest(part.forceless_depth, part.forceless, all.forceless_depth, all.forceless);
  if (part.wall_share > all.wall_share) all.wall_depth = part.wall_depth;
  add_largest(part.wall_share, part.in_wall, all.wall_share, all.in_wall);
}

} // namespace

struct ContactModel::PartialSums {
  PenaltyEnergy energy;
  struct OfPair {
    Point3 force{}, deepest{}, forceless{}, in_wall{};
    double normal_force = 0, friction_force = 0, largest_depth = 0, area = 0, forceless_depth = 0;
    double wall_share = 0, wall_depth = 0;
    std::int64_t touches = 0;
  };
  std::vector<OfPair> pairs;
  struct OnRigid {
    Point3 force{}, moment{}; ///< moment about the centre
  };
  std::vector<OnRigid> rigid;
};

Point3 ContactModel::friction(const Touch& touch, const Spring& spring, const ContactPair& pair, double normal_force,
                              const StepTimes& times, Memory& memory, PenaltyEnergy& energy) {
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
    energy.damping += c * dot(sliding, sliding) * times.dt_last;
    memory.traction = elastic;
    return total;
  }
  energy.friction += 0.5 * (std::min(before, trial) + limit) * std::max(0.0, trial - limit) / k;
  return memory.traction = iga::times(total, limit / size);
}

void ContactModel::apply_forces(const StepTimes& times) {
  touch_force_.resize(touches_.size());
  std::vector<PartialSums> parts(num_chunks(touches_.size(), grain));
  for_chunks(touches_.size(), grain, [&](std::size_t part, std::size_t first, std::size_t last) {
    PartialSums& sums = parts[part];
    sums.pairs.resize(report_.pairs.size());
    sums.rigid.resize(rigid_.size());
    for (std::size_t c = first; c < last; ++c) apply_force(c, times, sums);
  });
  for (PairForce& pair : report_.pairs) pair = {pair.name, {}, 0, 0, 0, {}, 0, 0, pair.span_size};
  for (const PartialSums& sums : parts) {
    report_.energy.friction += sums.energy.friction;
    report_.energy.damping += sums.energy.damping;
    for (std::size_t p = 0; p < sums.pairs.size(); ++p) add(sums.pairs[p], report_.pairs[p]);
    for (std::size_t r = 0; r < rigid_.size(); ++r) rigid_[r].add_resultant(sums.rigid[r].force, sums.rigid[r].moment);
  }
}

void ContactModel::apply_force(std::size_t c, const StepTimes& times, PartialSums& sums) {
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
  sums.energy.damping -= (normal_force - elastic) * opening * times.dt_last;
  const Point3 tangential = friction(touch, spring, settings, normal_force, times, memory, sums.energy);
  const Point3 force = plus(iga::times(touch.normal, normal_force), tangential);
  touch_force_[c] = force;
  if (touch.rigid >= 0) {
    PartialSums::OnRigid& on = sums.rigid[at(touch.rigid)];
    const Point3 push = iga::times(force, touch.rigid_sign);
    const Eigen::Vector3d& centre = rigid_[at(touch.rigid)].pose().centre;
    on.force = plus(on.force, push);
    on.moment = plus(on.moment, cross(minus(touch.point, {centre[0], centre[1], centre[2]}), push));
  }
  PartialSums::OfPair& pair = sums.pairs[pair_of_[c]];
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

void ContactModel::hand_back(std::span<const BodyState> bodies, const StepTimes& times) {
  double work = 0; // of the contact forces on all bodies, trapezoidal
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    const auto& active = surface.active();
    for_indices(active.size(), grain, [&](std::size_t k) {
      Point3 sum{};
      for (const TouchesAtVertices::Entry& e : at_vertices_.of(s, active[k]))
        sum = plus(sum, iga::times(touch_force_[at(e.touch)], touches_[at(e.touch)].entries[at(e.place)].weight));
      vertex_force_[s][at(active[k])] = sum;
    });
    work += times.dt_last * hand_back(surface, bodies[surface.owner()], vertex_force_[s]);
  }
  if (times.dt_last > 0)
    for (const RigidState& body : rigid_) work += body.work_of_forces();
  report_.energy.stored = -work - report_.energy.friction - report_.energy.damping;
}

// Puts the forces on the nodes; returns the power of their mean with those of the last step. Pieces of the nodes that
// nothing touches now or touched then are left out.
double ContactModel::hand_back(const MovingSurface& surface, const BodyState& body,
                               const std::vector<Point3>& at_vertices) {
  Eigen::VectorXd& last = last_force_[surface.owner()];
  auto& last_touched = last_touched_[surface.owner()];
  const std::size_t num_nodes = surface.columns().rows(), pieces = num_chunks(num_nodes, nodes_of_piece);
  if (last_touched.size() != pieces) last_touched.assign(pieces, 1);
  const SparseRows& T = surface.active_columns();
  const auto& nodes = surface.active_nodes();
  std::vector<double> power(pieces, 0);
  for_chunks(num_nodes, nodes_of_piece, [&](std::size_t piece, std::size_t begin, std::size_t end) {
    auto next = std::lower_bound(nodes.begin(), nodes.end(), static_cast<std::int32_t>(begin));
    const bool touched = !touches_.empty() && next != nodes.end() && at(*next) < end;
    if (!touched && !last_touched[piece]) return;
    for (std::size_t i = begin; i < end; ++i) {
      Point3 force{};
      if (touched && next != nodes.end() && at(*next) == i) {
        ++next;
        for (auto e = at(T.first[i]); e < at(T.first[i + 1]); ++e)
          force = plus(force, iga::times(at_vertices[at(T.column[e])], T.value[e]));
      }
      for (std::size_t d = 0; d < 3; ++d) {
        const auto k = static_cast<Eigen::Index>(3 * i + d);
        (*body.force)[k] += force[d];
        power[piece] += 0.5 * (force[d] + last[k]) * (*body.velocity)[k];
        last[k] = force[d];
      }
    }
    last_touched[piece] = touched ? 1 : 0;
  });
  double sum = 0;
  for (const double part : power) sum += part;
  return sum;
}

} // namespace iga::solve
