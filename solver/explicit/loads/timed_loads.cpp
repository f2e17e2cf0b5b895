#include "solver/explicit/loads/timed_loads.hpp"

#include "format/model/errors.hpp"
#include "solver/base/in_order.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d deformation_gradient(const SpanShapes& shapes, Index q, std::span<const std::int32_t> nodes,
                              const Eigen::VectorXd& u) {
  Matrix3d F = Matrix3d::Identity();
  for (std::size_t r = 0; r < nodes.size(); ++r)
    F += u.segment<3>(3 * nodes[r]) * shapes.gradients.row(q).segment<3>(3 * static_cast<Index>(r));
  return F;
}

/// J F⁻ᵀ: turns reference area vectors into current ones, singular or not.
Matrix3d cofactor(const Matrix3d& F) {
  Matrix3d C;
  C.row(0) = F.row(1).cross(F.row(2));
  C.row(1) = F.row(2).cross(F.row(0));
  C.row(2) = F.row(0).cross(F.row(1));
  return C;
}

} // namespace

TimedLoads::TimedLoads(const SolutionSpace& space, std::size_t body, double density,
                       const std::vector<TimedLoad>& loads)
    : space_(&space), body_(body) {
  for (const TimedLoad& timed : loads) {
    if (timed.load.rigid)
      throw InputError(
          fmt::format("load '{}': explicit runs keep no region rigid; leave spread = \"rigid\" out: the force "
                      "and the moment are spread evenly",
                      timed.load.name));
    LoadTerms terms = assemble_loads(space, density, std::span(&timed.load, 1));
    reports_.push_back(std::move(terms.reports[0]));
    if (!timed.follows) {
      dead_.push_back({timed.factor, std::move(terms.load)});
      continue;
    }
    const std::string what = fmt::format("load '{}'", timed.load.name);
    if (timed.load.kind != LoadKind::Pressure)
      throw InputError(
          fmt::format("{}: only a pressure can follow the surface; give a pressure or let it not follow", what));
    Follower follower{timed.factor, timed.load.pressure, choose_region(space.model(), timed.load.region, what), {}, {}};
    for (std::size_t s = 0; s < follower.region.cells.size(); ++s) {
      follower.batches.push_back(gather(space.model(), follower.region, s));
      follower.shapes.emplace_back();
      evaluate(space, follower.batches[s].cell, follower.batches[s].parameters, Shapes::Both, follower.shapes[s]);
    }
    followers_.push_back(std::move(follower));
  }
}

void TimedLoads::add_forces(const StepTimes& times, std::span<const BodyState> bodies) {
  const BodyState& state = bodies[body_];
  for (const Dead& load : dead_) *state.force += load.factor.value(times.time) * load.force;
  for (const Follower& load : followers_) add_follower(load, load.factor.value(times.time) * load.pressure, state);
}

void TimedLoads::add_follower(const Follower& load, double pressure, const BodyState& state) const {
  if (pressure == 0) return;
  in_order(
      load.region.cells.size(),
      [&](std::size_t s) {
        const PointBatch& batch = load.batches[s];
        const auto nodes = space_->nodes(batch.cell);
        Eigen::MatrixXd forces(3, static_cast<Index>(batch.size()));
        for (std::size_t q = 0; q < batch.size(); ++q) {
          const Matrix3d F = deformation_gradient(load.shapes[s], static_cast<Index>(q), nodes, *state.displacement);
          const Vector3d area = cofactor(F) * Vector3d(batch.normals[q].data());
          for (Index d = 0; d < 3; ++d) forces(d, static_cast<Index>(q)) = -pressure * batch.weights[q] * area[d];
        }
        return Eigen::MatrixXd(forces * load.shapes[s].values);
      },
      [&](std::size_t s, const Eigen::MatrixXd& nodal) {
        const auto nodes = space_->nodes(load.batches[s].cell);
        for (std::size_t r = 0; r < nodes.size(); ++r)
          state.force->segment<3>(3 * nodes[r]) += nodal.col(static_cast<Index>(r));
      });
}

} // namespace iga::solve
