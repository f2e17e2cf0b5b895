// Stiffness of the contact springs and the budget of stability they share: numerics in README.md, section 3.
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/explicit/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr std::size_t grain = 64;
// Of a touch whose limit the initial penetration has used up, this share is left.
constexpr double least_limit = 0.1;
// A spring that stiffens asks for a step no shorter than this share of the present one, in which its depth comes nearer
// to the limit by no more than `approach` of what is left.
constexpr double shortest_next_step = 0.7, approach = 0.25;
// It asks from this share of its limit on; before, it is as stiff as the present step allows.
constexpr double hard_share = 2.0 / 3;

/// Damping c = 2 ξ √(k m) with m = k dt² / η counts like a spring of 2 c / dt.
double damping_factor(const ContactPair& pair) {
  return pair.stiffness > 0 ? 4 * pair.damping / std::sqrt(pair.stiffness) : 0;
}

double room(const BodyState& body, std::size_t node, const StepTimes& times) {
  const auto i = static_cast<Eigen::Index>(node);
  return times.budget * (*body.masses)[i] / (body.mass_passes * times.dt * times.dt) - (*body.penalty_sum)[i];
}

double ratio(double sum, double room) {
  if (sum <= 0) return 0;
  return room > 0 ? sum / room : inf;
}

double share_of(double load) {
  return load > 1 ? 1 / load : 1;
}

/// Σ_j |S_vj| z_j.
double over_row(const SparseRows& S, std::int32_t v, const Eigen::VectorXd& z) {
  double sum = 0;
  for (auto e = at(S.first[at(v)]); e < at(S.first[at(v) + 1]); ++e) sum += std::abs(S.value[e]) * z[S.column[e]];
  return sum;
}

} // namespace

void ContactModel::share_budget(std::span<const BodyState> bodies, const StepTimes& times) {
  reference_dt_ = times.dt;
  StepTimes later = times;
  later.budget = times.budget_to_last();
  density_.assign(surfaces_.size(), {});
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    const ContactMesh& mesh = surface.mesh();
    double strongest = 0;
    std::vector<std::uint8_t> takes_part(mesh.vertices.size(), 0);
    for (const PairSearch& search : searches_) {
      if (search.first() != s && search.second() != s) continue;
      strongest = std::max(strongest, search.pair().stiffness * (1 + damping_factor(search.pair())));
      const auto& mask = search.mask(s).vertex;
      for (std::size_t v = 0; v < mask.size(); ++v) takes_part[v] |= mask[v];
    }
    auto& density = density_[s];
    density.assign(mesh.vertices.size(), 0);
    for (std::size_t v = 0; v < density.size(); ++v) {
      if (!takes_part[v]) continue;
      double slab = 0.5 * surface.span_size(); // or half the wall
      for (const std::int32_t f : mesh.faces_of(static_cast<std::int32_t>(v)))
        slab = std::min(slab, 0.5 * mesh.thickness[at(f)]);
      density[v] = surface.density() * slab / (reference_dt_ * reference_dt_);
    }
    // All faces that look one way in contact at once, for each of six ways: what lies around an edge touches different
    // things, if ever at once (then the budget of the step decides).
    std::vector<double> share(density.size(), 1);
    Eigen::VectorXd load(static_cast<Eigen::Index>(surface.columns().rows()));
    for (std::size_t way = 0; way < 6; ++way) {
      std::vector<double> sums(mesh.vertices.size(), 0);
      for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const double facing = (way % 2 == 0 ? 1 : -1) * mesh.face_normal[f][way / 2];
        if (facing <= 0) continue;
        for (const std::int32_t v : mesh.triangles[f])
          sums[at(v)] += strongest * density[at(v)] * facing * mesh.face_area[f] / 3;
      }
      sum_at_nodes(surface.columns(), surface.nodes(), sums, load);
      for (const std::int32_t i : surface.nodes())
        load[i] = ratio(load[i], room(bodies[surface.owner()], at(i), later));
      for (std::size_t v = 0; v < share.size(); ++v)
        if (sums[v] > 0)
          share[v] = std::min(share[v], share_of(over_row(surface.rows(), static_cast<std::int32_t>(v), load)));
    }
    for (std::size_t v = 0; v < density.size(); ++v) density[v] *= share[v];
  }
}

void ContactModel::set_springs() {
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    const ContactPair& pair = searches_[pair_of_[c]].pair();
    double ahead = 0, behind = 0; // the sides' own densities; a rigid side has none to lower the other's
    for (int i = 0; i < touch.count; ++i) {
      const Touch::Entry& e = touch.entries[at(i)];
      (e.weight > 0 ? ahead : behind) += std::abs(e.weight) * density_[e.surface][at(e.vertex)];
    }
    double reduced = 0;
    if (touch.rigid >= 0)
      reduced = std::max(ahead, behind);
    else if (ahead > 0 && behind > 0)
      reduced = ahead * behind / (ahead + behind);
    Spring& spring = springs_[c];
    spring.stiffness = pair.stiffness * reduced * memory_[c].area * memory_[c].factor;
    spring.with_damping = 1 + damping_factor(pair);
    spring.potential = {std::max(touch.limit - memory_[c].baseline, least_limit * touch.limit),
                        DepthPotential::hardest};
    spring.ratio = spring.potential.at(elastic_depth(c)).stiffness;
  }
}

double ContactModel::elastic_depth(std::size_t c) const {
  return touches_[c].depth - memory_[c].baseline - memory_[c].spring.shift;
}

// What is too stiff for this step is made softer, and the next one shorter, as far as springs stiffen with their depth.
void ContactModel::want_step(const StepTimes& times) {
  wanted_step_ = inf;
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    Spring& spring = springs_[c];
    const double closing = -dot(spring.velocity, touches_[c].normal);
    // A spring that opens keeps the potential it was loaded with.
    if (spring.ratio <= 1 || closing <= 0) spring.potential.largest_ratio = memory_[c].spring.largest_ratio;
    if (spring.ratio <= 1) continue;
    double wanted = inf;
    const bool nears_limit = elastic_depth(c) > hard_share * spring.potential.limit;
    if (spring.load > 1) {
      // The tangent k · ratio may be k · ratio · scale: taken from what has stiffened first.
      if (nears_limit) wanted = times.dt / std::sqrt(spring.load);
      const double tangent = spring.ratio * spring.scale;
      spring.potential.largest_ratio = std::min(spring.potential.largest_ratio, std::max(tangent, 1.0));
      spring.scale = std::min(tangent, 1.0);
    }
    const double left = std::max(spring.potential.limit - elastic_depth(c), 0.0);
    if (nears_limit && closing * times.dt > approach * left) wanted = std::min(wanted, approach * left / closing);
    wanted = std::max(wanted, shortest_next_step * times.dt);
    if (wanted < wanted_step_) {
      wanted_step_ = wanted;
      wanting_ = c;
    }
  }
}

std::string ContactModel::step_reason() const {
  if (!(wanted_step_ < inf) || wanted_step_ > largest_step() || wanting_ >= touches_.size()) return {};
  const Touch& touch = touches_[wanting_];
  return fmt::format("contact '{}' is pressed {:.3g} deep near ({:.6g}, {:.6g}, {:.6g}), where {:.3g} is the limit",
                     searches_[pair_of_[wanting_]].pair().name, touch.depth, touch.point[0], touch.point[1],
                     touch.point[2], touch.limit);
}

void ContactModel::sum_at_nodes(const SparseRows& T, const std::vector<std::int32_t>& nodes,
                                const std::vector<double>& at_vertices, Eigen::VectorXd& sums) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), grain), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const std::size_t i = at(nodes[k]);
      double sum = 0;
      for (auto e = at(T.first[i]); e < at(T.first[i + 1]); ++e)
        sum += std::abs(T.value[e]) * at_vertices[at(T.column[e])];
      sums[nodes[k]] = sum;
    }
  });
}

void ContactModel::sum_at_vertices() {
  for (auto& sums : vertex_sum_) std::fill(sums.begin(), sums.end(), 0.0);
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    const Spring& s = springs_[c];
    const double k = s.stiffness * s.ratio * s.with_damping * s.scale * s.load;
    for (int i = 0; i < touch.count; ++i) {
      const Touch::Entry& e = touch.entries[at(i)];
      vertex_sum_[e.surface][at(e.vertex)] += k * std::abs(e.weight);
    }
  }
}

void ContactModel::load_rigid(const StepTimes& times) {
  std::fill(rigid_load_.begin(), rigid_load_.end(), 0.0);
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    if (touch.rigid < 0 || !rigid_[at(touch.rigid)].is_free()) continue;
    const RigidState& body = rigid_[at(touch.rigid)];
    const Eigen::Vector3d& centre = body.pose().centre;
    const Point3 arm = minus(touch.point, {centre[0], centre[1], centre[2]});
    springs_[c].lever = 1 + norm(arm) / body.radius_of_gyration();
    const Spring& s = springs_[c];
    rigid_load_[at(touch.rigid)] += s.stiffness * s.ratio * s.with_damping * s.lever;
  }
  for (std::size_t r = 0; r < rigid_.size(); ++r)
    rigid_load_[r] = ratio(rigid_load_[r], times.budget * rigid_[r].mass() / (times.dt * times.dt));
}

void ContactModel::keep_within_budget(std::span<const BodyState> bodies, const StepTimes& times) {
  if (touches_.empty()) return;
  load_rigid(times);
  sum_at_vertices();
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    sum_at_nodes(surface.active_columns(), surface.active_nodes(), vertex_sum_[s], node_load_[s]);
    for (const std::int32_t i : surface.active_nodes())
      node_load_[s][i] = ratio(node_load_[s][i], room(bodies[surface.owner()], at(i), times));
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, touches_.size(), grain), [&](const auto& range) {
    for (std::size_t c = range.begin(); c != range.end(); ++c) {
      const Touch& touch = touches_[c];
      Spring& spring = springs_[c];
      spring.load = spring.lever > 0 ? spring.lever * rigid_load_[at(touch.rigid)] : 0;
      for (int i = 0; i < touch.count; ++i) {
        const Touch::Entry& e = touch.entries[at(i)];
        spring.load += std::abs(e.weight) * over_row(surfaces_[e.surface].rows(), e.vertex, node_load_[e.surface]);
      }
      spring.scale = share_of(spring.load);
    }
  });
  for (Spring& spring : springs_) {
    report_.least_scale = std::min(report_.least_scale, spring.scale);
    if (!(spring.load < inf)) spring.load = 0; // without force
  }
  // What the springs take of each node's room: Σ k |a_i| load / load_i, at most all of it.
  sum_at_vertices();
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    sum_at_nodes(surface.active_columns(), surface.active_nodes(), vertex_sum_[s], node_sum_[s]);
    Eigen::VectorXd& sum = *bodies[surface.owner()].penalty_sum;
    for (const std::int32_t i : surface.active_nodes())
      if (node_load_[s][i] > 0) sum[i] += node_sum_[s][i] / node_load_[s][i];
  }
}

} // namespace iga::solve
