#include "solver/supports/added_mass.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/average_motion.hpp"
#include "solver/supports/body_choice.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

double extent_of(const RegionReport& report) {
  return report.extent == Extent::Surface ? report.area : report.extent == Extent::Line ? report.length : 1;
}

// W with Wᵀ W = Tᵀ diag(m, J) T, T the motion of the body's centre.
RowMatrix rigid_rows(const BodySystem& system, const PreparedMass& mass) {
  const RowMatrix motion = average_motion(system, mass.body, mass.region);
  const SymmetricEigen inertia = symmetric_eigen(mass.added.inertia);
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(6, 6);
  Eigen::Index rank = 0;
  if (mass.added.mass > 0)
    for (Eigen::Index d = 0; d < 3; ++d) root(rank++, d) = std::sqrt(mass.added.mass);
  for (Eigen::Index k = 0; k < 3; ++k)
    if (inertia.values[k] > 1e-14 * inertia.values[2]) // a rod has no inertia about its axis, to rounding
      root.row(rank++).tail<3>() = std::sqrt(inertia.values[k]) * inertia.vectors.col(k).transpose();
  const Eigen::MatrixXd at_centre = root.topRows(rank) * moved_to(mass.centre, mass.region.report.centroid);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < rank; ++k)
    for (Eigen::Index m = 0; m < 6; ++m)
      if (at_centre(k, m) != 0)
        for (RowMatrix::InnerIterator it(motion, m); it; ++it)
          entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), at_centre(k, m) * it.value());
  RowMatrix rows(rank, system.num_unknowns());
  rows.setFromTriplets(entries.begin(), entries.end()); // adds up what several motions give
  return rows;
}

/// use(nodes, values, weights · mass per extent) for the cells of a mass that is spread.
template <class Use> void for_spread(const BodySystem& system, const PreparedMass& mass, Use&& use) {
  const SolutionSpace& space = *system[mass.body].space;
  const double density = mass.added.mass / extent_of(mass.region.report);
  SpanShapes shapes;
  for (std::size_t s = 0; s < mass.region.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), mass.region, s);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    const Eigen::VectorXd weights =
        density * Eigen::Map<const Eigen::VectorXd>(batch.weights.data(), static_cast<Eigen::Index>(batch.size()));
    use(space.nodes(batch.cell), shapes.values, weights);
  }
}

void refuse_rigid(std::span<const PreparedMass> added, MassType type) {
  if (type == MassType::Consistent) return;
  for (const PreparedMass& mass : added)
    if (mass.added.rigid)
      throw InputError(fmt::format(
          "added mass '{}': a rigid body couples all functions of its region, which only mass = \"consistent\" knows; "
          "use that, or spread the mass over the surface (leave 'at' and 'inertia' out). Added mass lowers every "
          "frequency: a time step that is safe without it is safe with it",
          mass.added.name));
}

} // namespace

std::vector<PreparedMass> prepare_masses(const BodySystem& system, std::span<const AddedMass> masses) {
  std::vector<PreparedMass> all;
  for (const AddedMass& added : masses) {
    const std::string what = fmt::format("added mass '{}'", added.name);
    const auto choose = [&](std::size_t b) {
      const TrimmedModel& model = system[b].space->model();
      return added.place.given() ? choose_places(model, added.place, what) : choose_region(model, added.region, what);
    };
    PreparedMass mass;
    mass.added = added;
    mass.body = chosen_body(system, added.body, what, choose);
    mass.region = choose(mass.body);
    mass.region.report.name = added.name;
    mass.region.report.body = system.name_among_several(mass.body);
    mass.centre = added.centre.value_or(mass.region.report.centroid);
    mass.rows.resize(0, system.num_unknowns());
    if (added.rigid) mass.rows = rigid_rows(system, mass);
    all.push_back(std::move(mass));
  }
  return all;
}

MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       std::span<const PreparedMass> added) {
  refuse_rigid(added, type);
  AddedMassTerms terms;
  terms.lumped = Eigen::VectorXd::Zero(system.num_nodes());
  for (const PreparedMass& mass : added) {
    if (mass.added.rigid) {
      terms.rows.push_back(mass.rows);
      continue;
    }
    const auto first_node = static_cast<std::int32_t>(system[mass.body].first_node);
    for_spread(system, mass, [&](auto nodes, const auto& values, const Eigen::VectorXd& weights) {
      AddedMassTerms::Block block;
      block.nodes.assign(nodes.begin(), nodes.end());
      block.first_node = first_node;
      block.matrix = values.transpose() * weights.asDiagonal() * values;
      const Eigen::VectorXd sums = values.transpose() * weights;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        terms.lumped[first_node + nodes[i]] += sums[static_cast<Eigen::Index>(i)];
      terms.blocks.push_back(std::move(block));
    });
  }
  return make_mass(type, system, connectivity, terms);
}

Eigen::VectorXd weight_of(const BodySystem& system, const PreparedMass& mass, const Point3& acceleration) {
  const Eigen::Vector3d a = as_vector(acceleration);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(system.num_unknowns());
  if (mass.added.rigid) {
    const Eigen::VectorXd field = a.replicate(system.num_nodes(), 1);
    return mass.rows.transpose() * (mass.rows * field);
  }
  for_spread(system, mass, [&](auto nodes, const auto& values, const Eigen::VectorXd& weights) {
    const Eigen::VectorXd sums = values.transpose() * weights;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      force.segment<3>(3 * (system[mass.body].first_node + nodes[i])) += sums[static_cast<Eigen::Index>(i)] * a;
  });
  return force;
}

} // namespace iga::solve
