// Stiffness of the contact springs and the budget of stability they share: numerics in README.md, section 3.
#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"
#include "solver/explicit/contact/contact_model.hpp"
#include "solver/explicit/contact/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

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

/// use(node, Σ_v |T_iv| z_v) for each of the nodes, in parallel.
template <class Use>
void each_node_sum(const SparseRows& T, const std::vector<std::int32_t>& nodes, const std::vector<double>& z,
                   const Use& use) {
  for_indices(nodes.size(), grain, [&](std::size_t k) {
    const std::size_t i = at(nodes[k]);
    double sum = 0; // in the order of the vertices: those without a touch change nothing
    for (auto e = at(T.first[i]); e < at(T.first[i + 1]); ++e) sum += std::abs(T.value[e]) * z[at(T.column[e])];
    use(nodes[k], sum);
  });
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
      each_node_sum(surface.columns(), surface.nodes(), sums, [&](std::int32_t i, double sum) {
        load[i] = ratio(sum, room(bodies[surface.owner()], at(i), later));
      });
      for_indices(share.size(), grain, [&](std::size_t v) {
        if (sums[v] > 0) share[v] = std::min(share[v], share_of(sum_of_sizes(surface.rows(), v, load.data())));
      });
    }
    for (std::size_t v = 0; v < density.size(); ++v) density[v] *= share[v];
  }
}

void ContactModel::set_springs() {
  for_indices(touches_.size(), grain, [&](std::size_t c) {
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
  });
}

double ContactModel::elastic_depth(std::size_t c) const {
  return touches_[c].depth - memory_[c].baseline - memory_[c].spring.shift;
}

// What is too stiff for this step is made softer, and the next one shorter, as far as springs stiffen with their depth.
void ContactModel::want_step(const StepTimes& times) {
  struct Wanted {
    double step = inf;
    std::size_t touch = 0;
  };
  std::vector<Wanted> parts(num_chunks(touches_.size(), grain));
  const auto wanted_by = [&](std::size_t c) {
    Spring& spring = springs_[c];
    const double closing = -dot(spring.velocity, touches_[c].normal);
    // A spring that opens keeps the potential it was loaded with.
    if (spring.ratio <= 1 || closing <= 0) spring.potential.largest_ratio = memory_[c].spring.largest_ratio;
    if (spring.ratio <= 1) return inf;
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
    return std::max(wanted, shortest_next_step * times.dt);
  };
  for_chunks(touches_.size(), grain, [&](std::size_t part, std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      if (const double wanted = wanted_by(c); wanted < parts[part].step) parts[part] = {wanted, c};
  });
  wanted_step_ = inf;
  for (const Wanted& part : parts)
    if (part.step < wanted_step_) {
      wanted_step_ = part.step;
      wanting_ = part.touch;
    }
}

std::string ContactModel::step_reason() const {
  if (!(wanted_step_ < inf) || wanted_step_ > largest_step() || wanting_ >= touches_.size()) return {};
  const Touch& touch = touches_[wanting_];
  return fmt::format("contact '{}' is pressed {:.3g} deep near ({:.6g}, {:.6g}, {:.6g}), where {:.3g} is the limit",
                     searches_[pair_of_[wanting_]].pair().name, touch.depth, touch.point[0], touch.point[1],
                     touch.point[2], touch.limit);
}

// Of active vertices.
void ContactModel::sum_at_vertices() {
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const auto& active = surfaces_[s].active();
    for_indices(active.size(), grain, [&](std::size_t k) {
      double sum = 0;
      for (const TouchesAtVertices::Entry& e : at_vertices_.of(s, active[k])) {
        const Spring& spring = springs_[at(e.touch)];
        sum += spring.stiffness * spring.ratio * spring.with_damping * spring.scale * spring.load *
               std::abs(touches_[at(e.touch)].entries[at(e.place)].weight);
      }
      vertex_sum_[s][at(active[k])] = sum;
    });
  }
}

void ContactModel::load_rigid(const StepTimes& times) {
  const std::size_t n = rigid_.size();
  std::vector<double> parts(n * num_chunks(touches_.size(), grain), 0);
  for_chunks(touches_.size(), grain, [&](std::size_t part, std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      const Touch& touch = touches_[c];
      if (touch.rigid < 0 || !rigid_[at(touch.rigid)].is_free()) continue;
      const RigidState& body = rigid_[at(touch.rigid)];
      const Eigen::Vector3d& centre = body.pose().centre;
      const Point3 arm = minus(touch.point, {centre[0], centre[1], centre[2]});
      springs_[c].lever = 1 + norm(arm) / body.radius_of_gyration();
      const Spring& s = springs_[c];
      parts[n * part + at(touch.rigid)] += s.stiffness * s.ratio * s.with_damping * s.lever;
    }
  });
  std::fill(rigid_load_.begin(), rigid_load_.end(), 0.0);
  for (std::size_t k = 0; k < parts.size(); ++k) rigid_load_[k % n] += parts[k];
  for (std::size_t r = 0; r < n; ++r)
    rigid_load_[r] = ratio(rigid_load_[r], times.budget * rigid_[r].mass() / (times.dt * times.dt));
}

void ContactModel::keep_within_budget(std::span<const BodyState> bodies, const StepTimes& times) {
  if (touches_.empty()) return;
  load_rigid(times);
  sum_at_vertices();
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    each_node_sum(surface.active_columns(), surface.active_nodes(), vertex_sum_[s], [&](std::int32_t i, double sum) {
      node_load_[s][i] = ratio(sum, room(bodies[surface.owner()], at(i), times));
    });
  }
  std::vector<double> least(num_chunks(touches_.size(), grain), 1);
  for_chunks(touches_.size(), grain, [&](std::size_t part, std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      const Touch& touch = touches_[c];
      Spring& spring = springs_[c];
      spring.load = spring.lever > 0 ? spring.lever * rigid_load_[at(touch.rigid)] : 0;
      for (int i = 0; i < touch.count; ++i) {
        const Touch::Entry& e = touch.entries[at(i)];
        spring.load +=
            std::abs(e.weight) * sum_of_sizes(surfaces_[e.surface].rows(), at(e.vertex), node_load_[e.surface].data());
      }
      spring.scale = share_of(spring.load);
      least[part] = std::min(least[part], spring.scale);
      if (!(spring.load < inf)) spring.load = 0; // without force
    }
  });
  for (const double scale : least) report_.least_scale = std::min(report_.least_scale, scale);
  if (is_last_) return;
  // What the springs take of each node's room: Σ k |a_i| load / load_i, at most all of it.
  sum_at_vertices();
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const MovingSurface& surface = surfaces_[s];
    if (surface.is_rigid()) continue;
    Eigen::VectorXd& penalty_sum = *bodies[surface.owner()].penalty_sum;
    each_node_sum(surface.active_columns(), surface.active_nodes(), vertex_sum_[s], [&](std::int32_t i, double sum) {
      if (node_load_[s][i] > 0) penalty_sum[i] += sum / node_load_[s][i];
    });
  }
}

} // namespace iga::solve
