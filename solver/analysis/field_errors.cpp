#include "solver/analysis/field_errors.hpp"

#include "solver/base/eigen_points.hpp"
#include "solver/supports/support_rows.hpp"

#include <algorithm>

namespace iga::solve {

namespace {

// The part of the field's own traction that a support may bear.
BorneTraction held_by(const PreparedSupport& support) {
  return [&support](const Point3& position, const Point3& normal, const Eigen::Vector3d& own) {
    const FixedDirections fixed = fixed_directions(support, normal, position);
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    for (std::size_t d = 0; d < static_cast<std::size_t>(fixed.count); ++d) {
      const Eigen::Vector3d e = as_vector(fixed.direction[d]);
      held += e.dot(own) * e;
    }
    return held;
  };
}

Eigen::Vector3d its_own(const Point3&, const Point3&, const Eigen::Vector3d& own) {
  return own;
}

BorneTraction given_by(const SurfaceLoad& load) {
  return [&load](const Point3& position, const Point3& normal, const Eigen::Vector3d&) {
    return as_vector(load.traction(position, normal));
  };
}

std::vector<LoadedRegion> held_regions(const BoundSystem& bound, std::size_t body) {
  std::vector<LoadedRegion> held;
  for (const PreparedSupport& support : bound.of_body[body].prepared)
    if (support.region.report.extent == Extent::Surface) held.push_back({&support.region, held_by(support)});
  const auto attached = [&](const auto& parts) { // may bear any traction, as a tie
    for (const auto& part : parts)
      if (part.body == body && part.region.report.extent == Extent::Surface) held.push_back({&part.region, its_own});
  };
  attached(bound.springs);
  for (const PreparedSpring& spring : bound.springs)
    if (spring.spring.to && spring.other_body == body && spring.other.report.extent == Extent::Surface)
      held.push_back({&spring.other, its_own});
  attached(bound.masses);
  for (const PreparedTie& tie : bound.ties)
    for (std::size_t side = 0; side < 2; ++side)
      if (tie.surface.body[side] == body) held.push_back({&tie.side[side].region, its_own});
  return held;
}

} // namespace

std::vector<Eigen::MatrixXd> field_errors(const BodySystem& system, const BoundSystem& bound,
                                          const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                                          const Eigen::VectorXd& lambda, std::span<const BodyLoads> loads) {
  std::vector<Eigen::MatrixXd> errors;
  for (std::size_t b = 0; b < system.size(); ++b) {
    ResidualProblem problem;
    problem.space = system[b].space.get();
    problem.material = &system[b].material;
    problem.unknowns = unknowns.middleRows(system[b].first_unknown(), system[b].space->num_unknowns());
    problem.lambda = lambda;
    problem.loaded = held_regions(bound, b);
    if (!loads.empty()) {
      problem.body_force = loads[b].body_force;
      for (const SurfaceLoad& load : loads[b].surfaces) problem.loaded.push_back({&load.region, given_by(load)});
      for (const SurfaceLoad& load : loads[b].rigid) problem.loaded.push_back({&load.region, its_own});
    }
    errors.push_back(residual_energy(problem));
  }
  return errors;
}

Eigen::VectorXd total_errors(std::span<const Eigen::MatrixXd> errors) {
  Eigen::VectorXd total = errors[0].colwise().sum();
  for (const Eigen::MatrixXd& body : errors.subspan(1)) total += body.colwise().sum().transpose();
  return total;
}

std::string no_field_errors(const BodySystem& system) {
  const bool is_smooth = std::all_of(system.begin(), system.end(), [](const SystemBody& body) {
    const auto p = body.space->model().grid.degree();
    return *std::min_element(p.begin(), p.end()) >= 2;
  });
  return is_smooth ? "" : "at degree 1 the residual lies on the faces of the spans";
}

} // namespace iga::solve
