#include "solver/mechanics/body_system.hpp"

#include "format/model/errors.hpp"

#include <fmt/format.h>
#include <limits>

namespace iga::solve {

BodySystem::BodySystem(const SolutionSpace& space, const ElasticMaterial& material) {
  add({}, std::shared_ptr<const SolutionSpace>(std::shared_ptr<const SolutionSpace>(), &space), material);
}

void BodySystem::add(std::string name, std::shared_ptr<const SolutionSpace> space, const ElasticMaterial& material) {
  const std::int64_t first_node = num_nodes_;
  num_nodes_ += space->num_nodes();
  if (num_nodes_ > std::numeric_limits<std::int32_t>::max())
    throw InputError(fmt::format("the bodies have {} nodes together, more than {} allowed; use larger spans",
                                 num_nodes_, std::numeric_limits<std::int32_t>::max()));
  bodies_.push_back({std::move(name), std::move(space), material, first_node});
}

std::string BodySystem::prefix(std::size_t b) const {
  return size() == 1 ? "" : fmt::format("body '{}': ", bodies_[b].name);
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> BodySystem::node_points() const {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(num_nodes_, 3);
  for (const SystemBody& body : bodies_)
    points.middleRows(body.first_node, body.space->num_nodes()) = body.space->node_points();
  return points;
}

std::shared_ptr<const Connectivity> BodySystem::connectivity(std::span<const std::vector<std::int32_t>> coupled) const {
  std::vector<const SolutionSpace*> spaces;
  for (const SystemBody& body : bodies_) spaces.push_back(body.space.get());
  return std::make_shared<const Connectivity>(spaces, coupled);
}

} // namespace iga::solve
