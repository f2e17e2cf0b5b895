#include "solver/explicit/loads/projected_region.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;

// Of the diagonal: makes dependent equations solvable; conjugate gradients take its trace away.
constexpr double shift = 1e-9;
// Of the constraint's terms: above rounding, which is no part of what the equations can meet.
constexpr double tolerance = 1e-10;
constexpr int most_iterations = 30;

} // namespace

ProjectedRegion::ProjectedRegion(const SolutionSpace& space, std::size_t body, DrivenRegion region)
    : body_(body), settings_(std::move(region)) {
  const std::string what = fmt::format("prescribed motion '{}'", settings_.name);
  if (!settings_.motion[0] && !settings_.motion[1] && !settings_.motion[2])
    throw InputError(fmt::format("{}: no component is prescribed; give a curve for x, y or z", what));
  const SurfaceRegion chosen = choose_region(space.model(), settings_.region, what);
  report_ = chosen.report;
  for (const std::int64_t span : chosen.cells)
    for (const std::int32_t i : space.nodes(span)) nodes_.push_back(i);
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  const auto n = static_cast<Index>(nodes_.size());
  area_ = Eigen::VectorXd::Zero(n);
  scale_ = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  SpanShapes shapes;
  for (std::size_t s = 0; s < chosen.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), chosen, s);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    const Eigen::Map<const Eigen::VectorXd> weights(batch.weights.data(), static_cast<Index>(batch.size()));
    const Eigen::MatrixXd N = shapes.values, local = N.transpose() * weights.asDiagonal() * N;
    const Eigen::VectorXd area = N.transpose() * weights;
    const Eigen::VectorXd scale = N.cwiseAbs().transpose() * weights.cwiseProduct(N.cwiseAbs().rowwise().sum());
    const auto own = space.nodes(batch.cell);
    std::vector<Index> number(own.size());
    for (std::size_t r = 0; r < own.size(); ++r)
      number[r] = std::lower_bound(nodes_.begin(), nodes_.end(), own[r]) - nodes_.begin();
    for (std::size_t r = 0; r < own.size(); ++r) {
      area_[number[r]] += area[static_cast<Index>(r)];
      scale_[number[r]] += scale[static_cast<Index>(r)];
      for (std::size_t c = 0; c < own.size(); ++c) {
        const double value = local(static_cast<Index>(r), static_cast<Index>(c));
        if (value != 0) entries.emplace_back(number[r], number[c], value);
      }
    }
  }
  G_.resize(n, n);
  G_.setFromTriplets(entries.begin(), entries.end());
  forces_ = accelerations_ = Eigen::VectorXd::Zero(space.num_unknowns());
}

double ProjectedRegion::target(std::size_t component, double t) const {
  const TimeCurve& curve = *settings_.motion[component];
  return settings_.curves_are_velocities ? curve.integral(t) : curve.value(t);
}

void ProjectedRegion::factorise(const MassOperator& mass) {
  const Eigen::VectorXd& masses = *mass.masses();
  Eigen::VectorXd inverse(static_cast<Index>(nodes_.size()));
  for (Index k = 0; k < inverse.size(); ++k) {
    const double m = masses[nodes_[static_cast<std::size_t>(k)]];
    inverse[k] = m > 0 ? 1 / m : 0;
  }
  Eigen::SparseMatrix<double> H = G_ * inverse.asDiagonal() * G_;
  const double largest = H.diagonal().maxCoeff();
  for (Index k = 0; k < H.rows(); ++k) H.coeffRef(k, k) += shift * (H.coeff(k, k) + shift * largest);
  factor_.compute(H);
  if (factor_.info() != Eigen::Success)
    throw NumericalError(fmt::format("prescribed motion '{}': the equations of its {} nodes cannot be factorised; "
                                     "choose a larger region or springs",
                                     settings_.name, nodes_.size()));
  factorised_ = true;
}

Matrix3Xd ProjectedRegion::accelerate(const MassOperator& mass, const Matrix3Xd& forces) {
  for (Index k = 0; k < forces.cols(); ++k) forces_.segment<3>(3 * nodes_[static_cast<std::size_t>(k)]) = forces.col(k);
  mass.divide(forces_.data(), accelerations_.data(), 1);
  Matrix3Xd result(3, forces.cols());
  for (Index k = 0; k < forces.cols(); ++k)
    result.col(k) = accelerations_.segment<3>(3 * nodes_[static_cast<std::size_t>(k)]);
  return result;
}

void ProjectedRegion::add_reactions(const StepTimes& times, std::span<const ConstrainedBody> bodies) {
  const ConstrainedBody& body = bodies[body_];
  if (!factorised_) factorise(*body.mass);
  const auto n = static_cast<Index>(nodes_.size());
  Matrix3Xd u(3, n), v(3, n);
  for (Index k = 0; k < n; ++k) {
    u.col(k) = body.displacement->segment<3>(3 * nodes_[static_cast<std::size_t>(k)]);
    v.col(k) = body.velocity->segment<3>(3 * nodes_[static_cast<std::size_t>(k)]);
  }
  const Matrix3Xd trace = weigh(u);
  Matrix3Xd rest = -weigh(v); // of the constraint, area · velocity
  largest_miss_ = 0;
  double size = 0; // of the constraint's terms
  for (std::size_t d = 0; d < 3; ++d) {
    const auto row = static_cast<Index>(d);
    if (!settings_.motion[d]) {
      rest.row(row).setZero();
      continue;
    }
    const Eigen::RowVectorXd now = trace.row(row) - target(d, times.time) * area_.transpose();
    largest_miss_ = std::max(largest_miss_, (now.array() / scale_.transpose().array().max(1e-300)).abs().maxCoeff());
    size += rest.row(row).squaredNorm();
    rest.row(row) += (target(d, times.time + times.dt) * area_.transpose() - trace.row(row)) / times.dt;
    size += rest.row(row).squaredNorm();
  }
  // Conjugate gradients for G M⁻¹ G λ = rest / gain; the shifted factor of lumped masses goes before.
  const auto before = [&](const Matrix3Xd& r) -> Matrix3Xd { return factor_.solve(r.transpose()).transpose(); };
  Matrix3Xd lambda = Matrix3Xd::Zero(3, n), r = rest / body.gain, z = before(r), p = z;
  const double enough = tolerance * std::sqrt(size) / body.gain;
  double rz = (r.array() * z.array()).sum();
  double last = 2 * r.norm();
  for (int k = 0; k < most_iterations && rz > 0 && r.norm() > enough && r.norm() < last; ++k) {
    last = r.norm();
    Matrix3Xd q = weigh(accelerate(*body.mass, weigh(p)));
    for (Index d = 0; d < 3; ++d)
      if (!settings_.motion[static_cast<std::size_t>(d)]) q.row(d).setZero();
    const double pq = (p.array() * q.array()).sum();
    if (!(pq > 0)) break;
    lambda += rz / pq * p;
    r -= rz / pq * q;
    z = before(r);
    const double next = (r.array() * z.array()).sum();
    p = z + next / rz * p;
    rz = next;
  }
  const Matrix3Xd reaction = weigh(lambda);
  for (Index k = 0; k < n; ++k) body.reaction->segment<3>(3 * nodes_[static_cast<std::size_t>(k)]) += reaction.col(k);
  const Eigen::Vector3d sum = reaction.rowwise().sum();
  force_ = {sum[0], sum[1], sum[2]};
}

} // namespace iga::solve
