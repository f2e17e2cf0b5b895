// Stiffness of the contact springs and the budget of stability they share: numerics in README.md, section 3.
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/contact_model.hpp"
#include "solver/explicit/contact/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr std::size_t grain = 64;
// Weight of a free rigid body in the bound, in shares of what its own mass would need: large enough for its own row,
// small enough not to burden the nodes.
constexpr double rigid_margin = 4;

/// Damping c = 2 ξ √(k m) with m = k dt² / η counts like a spring of 2 c / dt.
double damping_factor(const ContactPair& pair) {
  return pair.stiffness > 0 ? 4 * pair.damping / std::sqrt(pair.stiffness) : 0;
}

double room(const BodyState& body, std::size_t node, const StepTimes& times) {
  const auto i = static_cast<Eigen::Index>(node);
  return times.budget * (*body.masses)[i] / (body.mass_passes * times.dt * times.dt) - (*body.penalty_sum)[i];
}

double share_of(double room, double sum) {
  if (sum <= 0) return 1;
  return std::clamp(room / sum, 0.0, 1.0);
}

/// Smallest share over the nodes of a vertex.
double least_over_row(const SparseRows& S, std::int32_t v, const Eigen::VectorXd& share) {
  double least = 1;
  for (auto e = at(S.first[at(v)]); e < at(S.first[at(v) + 1]); ++e) least = std::min(least, share[S.column[e]]);
  return least;
}

} // namespace

void ContactModel::share_budget(std::span<const BodyState> bodies, const StepTimes& times) {
  reference_dt_ = times.dt;
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
    Eigen::VectorXd share = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(surface.columns().rows()));
    for (std::size_t way = 0; way < 6; ++way) {
      std::vector<double> sums(mesh.vertices.size(), 0);
      for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const double facing = (way % 2 == 0 ? 1 : -1) * mesh.face_normal[f][way / 2];
        if (facing <= 0) continue;
        for (const std::int32_t v : mesh.triangles[f])
          sums[at(v)] += strongest * density[at(v)] * facing * mesh.face_area[f] / 3 * surface.weight_sum(v);
      }
      const Eigen::VectorXd at_nodes = sum_at_nodes(surface, surface.nodes(), sums);
      for (const std::int32_t i : surface.nodes())
        share[i] = std::min(share[i], share_of(room(bodies[surface.owner()], at(i), times), at_nodes[i]));
    }
    for (std::size_t v = 0; v < density.size(); ++v)
      density[v] *= least_over_row(surface.rows(), static_cast<std::int32_t>(v), share);
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
    springs_[c].stiffness = pair.stiffness * reduced * touch.area;
    springs_[c].with_damping = 1 + damping_factor(pair);
  }
}

void ContactModel::weigh_rigid(const StepTimes& times) {
  std::fill(rigid_weight_.begin(), rigid_weight_.end(), 0.0);
  std::fill(rigid_sum_.begin(), rigid_sum_.end(), 0.0);
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    if (touch.rigid < 0 || !rigid_[at(touch.rigid)].is_free()) continue;
    const RigidState& body = rigid_[at(touch.rigid)];
    const Eigen::Vector3d& centre = body.pose().centre;
    const Point3 arm = minus(touch.point, {centre[0], centre[1], centre[2]});
    springs_[c].lever = 1 + norm(arm) / body.radius_of_gyration();
    rigid_weight_[at(touch.rigid)] += springs_[c].stiffness * springs_[c].with_damping * springs_[c].lever;
  }
  for (std::size_t r = 0; r < rigid_.size(); ++r)
    if (rigid_[r].is_free())
      rigid_weight_[r] =
          std::min(1.0, rigid_margin * rigid_weight_[r] * times.dt * times.dt / (times.budget * rigid_[r].mass()));
}

void ContactModel::sum_at_vertices(bool scaled) {
  for (auto& sums : vertex_sum_) std::fill(sums.begin(), sums.end(), 0.0);
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    const Spring& spring = springs_[c];
    const double k = spring.stiffness * spring.with_damping * spring.reach * (scaled ? spring.scale : 1);
    for (int i = 0; i < touch.count; ++i) {
      const Touch::Entry& e = touch.entries[at(i)];
      vertex_sum_[e.surface][at(e.vertex)] += k * std::abs(e.weight);
    }
  }
}

Eigen::VectorXd ContactModel::sum_at_nodes(const MovingSurface& surface, const std::vector<std::int32_t>& nodes,
                                           const std::vector<double>& at_vertices) const {
  const SparseRows& T = surface.columns();
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(T.rows()));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), grain), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      const std::size_t i = at(nodes[k]);
      double sum = 0;
      for (auto e = at(T.first[i]); e < at(T.first[i + 1]); ++e)
        sum += std::abs(T.value[e]) * at_vertices[at(T.column[e])];
      sums[nodes[k]] = sum;
    }
  });
  return sums;
}

void ContactModel::keep_within_budget(std::span<const BodyState> bodies, const StepTimes& times) {
  if (touches_.empty()) return;
  weigh_rigid(times);
  for (std::size_t c = 0; c < touches_.size(); ++c) {
    const Touch& touch = touches_[c];
    Spring& spring = springs_[c];
    spring.reach = 0;
    for (int i = 0; i < touch.count; ++i) {
      const Touch::Entry& e = touch.entries[at(i)];
      spring.reach += std::abs(e.weight) * surfaces_[e.surface].weight_sum(e.vertex);
    }
    if (spring.lever > 0) {
      const std::size_t r = at(touch.rigid);
      spring.reach += rigid_weight_[r] * spring.lever;
      rigid_sum_[r] += spring.stiffness * spring.with_damping * spring.reach * spring.lever;
    }
  }
  sum_at_vertices(false);
  std::vector<Eigen::VectorXd> sums(surfaces_.size()), share(surfaces_.size());
  const auto sum_up = [&] {
    for (std::size_t s = 0; s < surfaces_.size(); ++s)
      if (!surfaces_[s].is_rigid()) sums[s] = sum_at_nodes(surfaces_[s], surfaces_[s].active_nodes(), vertex_sum_[s]);
  };
  sum_up();
  double least = 1;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (surfaces_[s].is_rigid()) continue;
    share[s] = Eigen::VectorXd::Ones(sums[s].size());
    for (const std::int32_t i : surfaces_[s].active_nodes()) {
      share[s][i] = share_of(room(bodies[surfaces_[s].owner()], at(i), times), sums[s][i]);
      least = std::min(least, share[s][i]);
    }
  }
  std::vector<double> rigid_share(rigid_.size(), 1);
  for (std::size_t r = 0; r < rigid_.size(); ++r)
    if (rigid_sum_[r] > 0) {
      const double room = times.budget * rigid_[r].mass() * rigid_weight_[r] / (times.dt * times.dt);
      rigid_share[r] = share_of(room, rigid_sum_[r]);
      least = std::min(least, rigid_share[r]);
    }
  report_.least_scale = least;
  if (least < 1)
    for (std::size_t c = 0; c < touches_.size(); ++c) {
      const Touch& touch = touches_[c];
      for (int i = 0; i < touch.count; ++i) {
        const Touch::Entry& e = touch.entries[at(i)];
        springs_[c].scale =
            std::min(springs_[c].scale, least_over_row(surfaces_[e.surface].rows(), e.vertex, share[e.surface]));
      }
      if (touch.rigid >= 0) springs_[c].scale = std::min(springs_[c].scale, rigid_share[at(touch.rigid)]);
    }
  if (least < 1) {
    sum_at_vertices(true);
    sum_up();
  }
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    if (!surfaces_[s].is_rigid()) *bodies[surfaces_[s].owner()].penalty_sum += sums[s];
}

} // namespace iga::solve
