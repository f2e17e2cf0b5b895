#include "solver/supports/rigid_regions.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/spread_loads.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// C in β = C E / h, as for supports. More costs digits: a region that moves far by u has forces of β u that cancel.
constexpr double penalty_factor = 1e3;

// Columns: velocities at x of motions about the centre.
Eigen::MatrixXd velocities(const Eigen::Ref<const Eigen::MatrixXd>& motions, const Point3& centre, const Point3& x) {
  const Eigen::Vector3d r = as_vector(minus(x, centre));
  Eigen::MatrixXd v = motions.topRows(3);
  for (Eigen::Index k = 0; k < v.cols(); ++k) v.col(k) += Eigen::Vector3d(motions.col(k).tail(3)).cross(r);
  return v;
}

} // namespace

RigidRegions::RigidRegions(const BodySystem& system, std::span<const Load> loads,
                           std::span<const std::vector<std::size_t>> bodies, StiffnessMatrix& K)
    : system_(&system) {
  for (std::size_t k = 0; k < loads.size(); ++k) {
    if (!loads[k].rigid) continue;
    const TrimmedModel& model = system[bodies[k][0]].space->model();
    take(k, bodies[k][0], choose_region(model, loads[k].region, fmt::format("load '{}'", loads[k].name)),
         loads[k].remote);
  }
  add_regions(K);
}

RigidRegions::RigidRegions(const BodySystem& system, std::vector<Held> held, StiffnessMatrix& K) : system_(&system) {
  for (Held& one : held) take(0, one.body, std::move(one.region), {});
  add_regions(K);
}

void RigidRegions::take(std::size_t load, std::size_t b, SurfaceRegion region, const std::optional<Point3>& at) {
  const SystemBody& body = (*system_)[b];
  Region r{load, b, std::move(region), {}, 0, {}};
  r.at = at.value_or(r.region.report.centroid);
  r.beta = penalty_factor * penalty_stiffness(*body.space, body.material, Extent::Surface);
  const SymmetricEigen3 inertia = symmetric_eigen_3(turning_inertia(body.space->model(), r.region));
  r.basis.setZero();
  r.basis.topLeftCorner<3, 3>().diagonal().setConstant(1 / std::sqrt(r.region.report.area));
  r.basis.bottomRightCorner<3, 3>() = inertia.vectors * inertia.values.cwiseSqrt().cwiseInverse().asDiagonal();
  regions_.push_back(std::move(r));
}

void RigidRegions::add_regions(StiffnessMatrix& K) {
  U_ = Eigen::MatrixXd::Zero(system_->num_unknowns(), 6 * static_cast<Eigen::Index>(regions_.size()));
  for (const Region& r : regions_) add_region(r, K);
}

void RigidRegions::complete(StiffnessMatrix& K) const {
  if (!regions_.empty())
    K.add_low_rank(Eigen::MatrixXd(U_.transpose()).sparseView(), Eigen::VectorXd::Constant(U_.cols(), -1));
}

void RigidRegions::add_region(const Region& r, StiffnessMatrix& K) {
  const SolutionSpace& space = *(*system_)[r.body].space;
  const std::int64_t first_node = (*system_)[r.body].first_node;
  const Eigen::Index first = 6 * (&r - regions_.data());
  SpanShapes shapes;
  for (std::size_t s = 0; s < r.region.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), r.region, s);
    const auto nodes = space.nodes(batch.cell);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    const Eigen::Map<const Eigen::VectorXd> w(batch.weights.data(), static_cast<Eigen::Index>(batch.size()));
    const Eigen::MatrixXd products = r.beta * shapes.values.transpose() * w.asDiagonal() * shapes.values;
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * products.rows(), 3 * products.cols());
    for (Eigen::Index d = 0; d < 3; ++d)
      for (Eigen::Index j = 0; j < products.cols(); ++j)
        for (Eigen::Index i = 0; i < products.rows(); ++i) block(3 * i + d, 3 * j + d) = products(i, j);
    K.add(nodes, block, static_cast<std::int32_t>(first_node));
    for (std::size_t q = 0; q < batch.size(); ++q) {
      const Eigen::MatrixXd v =
          std::sqrt(r.beta) * batch.weights[q] * velocities(r.basis, r.region.report.centroid, batch.positions[q]);
      for (std::size_t i = 0; i < nodes.size(); ++i)
        U_.block(3 * (first_node + nodes[i]), first, 3, 6) +=
            shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i)) * v;
    }
  }
}

void RigidRegions::prepare(const LinearSolver& solver) {
  if (regions_.empty()) return;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(solver.size(), U_.cols());
  b.topRows(U_.rows()) = U_;
  solved_.resize(b.rows(), b.cols());
  for (Eigen::Index c = 0; c < b.cols(); ++c) solver.solve(b.col(c).data(), solved_.col(c).data(), 1);
  capacity_ = (Eigen::MatrixXd::Identity(U_.cols(), U_.cols()) - U_.transpose() * solved_.topRows(U_.rows())).inverse();
}

Eigen::VectorXd RigidRegions::solve(const LinearSolver& solver, const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = solver.solve(b);
  if (regions_.empty()) return x;
  const Eigen::VectorXd along = U_.transpose() * x.head(U_.rows());
  x += solved_ * (capacity_ * along);
  return x;
}

Eigen::Matrix<double, 6, 1> RigidRegions::motion_of(std::size_t r, const Eigen::VectorXd& u) const {
  const Region& region = regions_[r];
  const Eigen::Matrix<double, 6, 1> share = U_.middleCols<6>(6 * static_cast<Eigen::Index>(r)).transpose() * u;
  return region.basis * share / std::sqrt(region.beta);
}

double RigidRegions::energy(const Eigen::VectorXd& u) const {
  double energy = 0;
  SpanShapes shapes;
  for (std::size_t k = 0; k < regions_.size(); ++k) {
    const Region& r = regions_[k];
    const SolutionSpace& space = *(*system_)[r.body].space;
    const Eigen::VectorXd own = system_->part(u, r.body);
    const Eigen::Matrix<double, 6, 1> motion = motion_of(k, u);
    for (std::size_t s = 0; s < r.region.cells.size(); ++s) {
      const PointBatch batch = gather(space.model(), r.region, s);
      const auto nodes = space.nodes(batch.cell);
      evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
      for (std::size_t q = 0; q < batch.size(); ++q) {
        Eigen::Vector3d off = -velocities(motion, r.region.report.centroid, batch.positions[q]).col(0);
        for (std::size_t i = 0; i < nodes.size(); ++i)
          off +=
              shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i)) * own.segment<3>(3 * nodes[i]);
        energy += 0.5 * r.beta * batch.weights[q] * off.squaredNorm();
      }
    }
  }
  return energy;
}

std::vector<std::pair<std::size_t, RegionMotion>> RigidRegions::motions(const Eigen::VectorXd& u) const {
  std::vector<std::pair<std::size_t, RegionMotion>> all;
  for (std::size_t k = 0; k < regions_.size(); ++k) {
    const Region& r = regions_[k];
    const Eigen::Matrix<double, 6, 1> motion = motion_of(k, u);
    all.push_back(
        {r.load,
         {r.at, as_point(velocities(motion, r.region.report.centroid, r.at).col(0)), as_point(motion.tail<3>())}});
  }
  return all;
}

} // namespace iga::solve
