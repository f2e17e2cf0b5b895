#include "solver/explicit/loads/driven_region.hpp"

#include "format/model/errors.hpp"
#include "solver/base/in_order.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Index;

// The step may grow by this much before the springs are made anew.
constexpr double step_margin = 1.05;

} // namespace

RegionDrive::RegionDrive(const SolutionSpace& space, std::size_t body, double density, DrivenRegion region)
    : space_(&space), body_(body), density_(density), settings_(std::move(region)) {
  const std::string what = fmt::format("prescribed motion '{}'", settings_.name);
  if (!settings_.motion[0] && !settings_.motion[1] && !settings_.motion[2])
    throw InputError(fmt::format("{}: no component is prescribed; give a curve for x, y or z", what));
  if (!(settings_.stiffness > 0) || !(settings_.damping >= 0))
    throw InputError(fmt::format("{}: stiffness {} and damping {}; expected a stiffness above 0 and a damping of at "
                                 "least 0",
                                 what, settings_.stiffness, settings_.damping));
  region_ = choose_region(space.model(), settings_.region, what);
  SpanShapes shapes;
  for (std::size_t s = 0; s < region_.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), region_, s);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    patches_.push_back({batch.cell, shapes.values, batch.weights, std::vector<double>(batch.size(), 0.0)});
  }
  sums_ = Eigen::VectorXd::Zero(space.num_nodes());
}

double RegionDrive::target(std::size_t component, double t) const {
  const TimeCurve& curve = *settings_.motion[component];
  return settings_.curves_are_velocities ? curve.integral(t) : curve.value(t);
}

void RegionDrive::share_budget(const BodyState& state, const StepTimes& times) {
  reference_dt_ = times.dt * step_margin;
  const Point3 h = space_->model().grid.span_size();
  const double slab = 0.5 * std::min({h[0], h[1], h[2]});
  const double full = density_ * slab / (reference_dt_ * reference_dt_);
  const double with_damping = 1 + 4 * settings_.damping / std::sqrt(settings_.stiffness) * step_margin;
  const auto add_all = [&](Eigen::VectorXd& sums) {
    sums = Eigen::VectorXd::Zero(space_->num_nodes());
    for (const Patch& patch : patches_) {
      const auto nodes = space_->nodes(patch.span);
      for (Index q = 0; q < patch.values.rows(); ++q) {
        const auto p = static_cast<std::size_t>(q);
        const double k = settings_.stiffness * with_damping * patch.density[p] * patch.weights[p];
        const double reach = patch.values.row(q).cwiseAbs().sum();
        for (std::size_t r = 0; r < nodes.size(); ++r)
          sums[nodes[r]] += k * reach * std::abs(patch.values(q, static_cast<Index>(r)));
      }
    }
  };
  for (Patch& patch : patches_) patch.density.assign(patch.weights.size(), full);
  add_all(sums_);
  Eigen::VectorXd share = Eigen::VectorXd::Ones(sums_.size());
  for (Index i = 0; i < sums_.size(); ++i) {
    const double budget = settings_.budget_share < 1 ? settings_.budget_share * times.budget_to_last() : times.budget;
    const double room =
        budget * (*state.masses)[i] / (state.mass_passes * reference_dt_ * reference_dt_) - (*state.penalty_sum)[i];
    if (sums_[i] > 0) share[i] = std::clamp(room / sums_[i], 0.0, 1.0);
  }
  for (Patch& patch : patches_) {
    const auto nodes = space_->nodes(patch.span);
    for (Index q = 0; q < patch.values.rows(); ++q)
      for (std::size_t r = 0; r < nodes.size(); ++r)
        if (patch.values(q, static_cast<Index>(r)) != 0)
          patch.density[static_cast<std::size_t>(q)] =
              std::min(patch.density[static_cast<std::size_t>(q)], full * share[nodes[r]]);
  }
  add_all(sums_);
}

PenaltyEnergy RegionDrive::add_forces(const StepTimes& times, std::span<const BodyState> bodies) {
  const BodyState& state = bodies[body_];
  if (times.dt > reference_dt_) share_budget(state, times);
  Point3 goal{}, rate{};
  for (std::size_t d = 0; d < 3; ++d) {
    if (!settings_.motion[d]) continue;
    goal[d] = target(d, times.time);
    rate[d] = times.dt_last > 0 ? (goal[d] - target(d, times.time - times.dt_last)) / times.dt_last
                                : (target(d, times.time + times.dt) - goal[d]) / times.dt;
  }
  const double damping = 2 * settings_.damping / std::sqrt(settings_.stiffness) * reference_dt_;
  struct Part {
    Eigen::MatrixXd nodal; ///< (3 × nodes)
    Point3 force{};
    double stored = 0, dissipated = 0, miss = 0;
  };
  force_ = {};
  largest_miss_ = 0;
  double stored = 0, power = 0;
  in_order(
      patches_.size(),
      [&](std::size_t s) {
        const Patch& patch = patches_[s];
        const auto nodes = space_->nodes(patch.span);
        Eigen::MatrixXd u(3, static_cast<Index>(nodes.size())), v(u);
        for (std::size_t r = 0; r < nodes.size(); ++r) {
          u.col(static_cast<Index>(r)) = state.displacement->segment<3>(3 * nodes[r]);
          v.col(static_cast<Index>(r)) = state.velocity->segment<3>(3 * nodes[r]);
        }
        Part part;
        Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(3, patch.values.rows());
        for (Index q = 0; q < patch.values.rows(); ++q) {
          const auto p = static_cast<std::size_t>(q);
          const double k = settings_.stiffness * patch.density[p] * patch.weights[p];
          const Eigen::Vector3d at = u * patch.values.row(q).transpose(), moves = v * patch.values.row(q).transpose();
          for (std::size_t d = 0; d < 3; ++d) {
            if (!settings_.motion[d]) continue;
            const auto row = static_cast<Index>(d);
            const double miss = at[row] - goal[d], lag = moves[row] - rate[d];
            forces(row, q) = -k * (miss + damping * lag);
            part.force[d] += forces(row, q);
            part.stored += 0.5 * k * miss * miss;
            part.dissipated += k * damping * lag * lag;
            part.miss = std::max(part.miss, std::abs(miss));
          }
        }
        part.nodal = forces * patch.values;
        return part;
      },
      [&](std::size_t s, const Part& part) {
        const auto nodes = space_->nodes(patches_[s].span);
        for (std::size_t r = 0; r < nodes.size(); ++r)
          state.force->segment<3>(3 * nodes[r]) += part.nodal.col(static_cast<Index>(r));
        for (std::size_t d = 0; d < 3; ++d) force_[d] += part.force[d];
        stored += part.stored;
        power += part.dissipated;
        largest_miss_ = std::max(largest_miss_, part.miss);
      });
  *state.penalty_sum += sums_;
  for (std::size_t d = 0; d < 3; ++d) external_work_ += 0.5 * (force_[d] + last_force_[d]) * rate[d] * times.dt_last;
  last_force_ = force_;
  const PenaltyEnergy energy{stored - stored_, 0, power * times.dt_last};
  stored_ = stored;
  return energy;
}

std::vector<SavedArray> RegionDrive::save() const {
  std::vector<double> values{reference_dt_, external_work_, stored_, largest_miss_};
  values.insert(values.end(), last_force_.begin(), last_force_.end());
  for (const Patch& patch : patches_) values.insert(values.end(), patch.density.begin(), patch.density.end());
  values.insert(values.end(), sums_.data(), sums_.data() + sums_.size());
  return {{"supports/" + settings_.name, std::move(values), 0}};
}

void RegionDrive::load(std::span<const SavedArray> arrays) {
  auto next = arrays.front().values.begin();
  reference_dt_ = *next++;
  external_work_ = *next++;
  stored_ = *next++;
  largest_miss_ = *next++;
  for (double& f : last_force_) f = *next++;
  force_ = last_force_;
  for (Patch& patch : patches_) {
    for (double& k : patch.density) k = *next++;
  }
  for (Index i = 0; i < sums_.size(); ++i) sums_[i] = *next++;
}

} // namespace iga::solve
