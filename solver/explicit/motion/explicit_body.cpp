#include "solver/explicit/motion/explicit_body.hpp"

#include "format/model/errors.hpp"
#include "solver/base/parallel.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/element_bound.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>

namespace iga::solve {

namespace {

using Eigen::VectorXd;
using RowSparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// y = A x for each of the three components; rows in parallel.
void multiply(const RowSparse& A, const double* x, double* y) {
  for_indices(static_cast<std::size_t>(A.rows()), 1024, [&](std::size_t row) {
    const auto r = static_cast<Eigen::Index>(row);
    double sums[3] = {};
    for (RowSparse::InnerIterator it(A, r); it; ++it)
      for (Eigen::Index d = 0; d < 3; ++d) sums[d] += it.value() * x[3 * it.col() + d];
    for (Eigen::Index d = 0; d < 3; ++d) y[3 * r + d] = sums[d];
  });
}

MassOperator body_mass(const BodySettings& settings, const SolutionSpace& space,
                       const std::shared_ptr<const Connectivity>& connectivity, double density) {
  if (settings.mass == MassType::Consistent)
    throw InputError(fmt::format("body '{}': the consistent mass has no cheap inverse; choose lumped, two-pass or "
                                 "three-pass",
                                 settings.name));
  if (!(settings.damping >= 0) || !std::isfinite(settings.damping))
    throw InputError(fmt::format("body '{}': damping is {:g}, at least 0 is allowed", settings.name, settings.damping));
  return make_mass(settings.mass, space, connectivity, density);
}

} // namespace

ExplicitBody::ExplicitBody(const TrimmedModel& model, const BodySettings& settings, const Law& law)
    : settings_(settings), space_(std::make_unique<SolutionSpace>(model, settings.light)),
      connectivity_(settings.mass == MassType::Lumped ? nullptr : std::make_shared<const Connectivity>(*space_)),
      small_strain_(solve::small_strain(law)),
      mass_(body_mass(settings, *space_, connectivity_, small_strain_.density)),
      forces_(make_internal_forces(*space_, law, settings.kernel)) {
  plain_ = space_->is_plain();
  if (!plain_) {
    transposed_ = space_->extension().transpose();
    full_u_.resize(3 * space_->extension().rows());
    full_f_.resize(full_u_.size());
  }
  if (mass_.is_lumped()) inverse_mass_ = mass_.masses()->unaryExpr([](double m) { return m > 0 ? 1 / m : 0.0; });
  points_ = space_->node_points();
  displacement = velocity = momentum = internal = VectorXd::Zero(num_unknowns());
  const Eigen::Vector3d g(settings.acceleration.data());
  if (!g.isZero(0)) {
    weight_.resize(num_unknowns());
    for (Eigen::Index n = 0; n < space_->num_nodes(); ++n) weight_.segment<3>(3 * n) = (*mass_.masses())[n] * g;
  }
}

void ExplicitBody::set_velocity(VectorXd velocities) {
  velocity = std::move(velocities);
  momentum = mass_ * velocity;
}

void ExplicitBody::set_rigid_velocity(const Point3& v, const Point3& spin, const Point3& centre) {
  const Eigen::Vector3d v0(v.data()), w(spin.data()), c(centre.data());
  VectorXd coefficients(num_unknowns());
  for (Eigen::Index n = 0; n < points_.rows(); ++n)
    coefficients.segment<3>(3 * n) = v0 + w.cross(points_.row(n).transpose() - c);
  set_velocity(std::move(coefficients));
}

void ExplicitBody::set_velocity(const std::function<Point3(const Point3&)>& field) {
  // On the plain functions, which are nowhere negative; a node keeps the coefficient of its own function.
  const SolutionSpace plain(space_->model(), {});
  const TrimmedModel& model = space_->model();
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> sums =
      Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>::Zero(plain.num_nodes(), 4);
  SpanShapes shapes;
  for (std::int64_t a = 0; a < plain.num_cells(); ++a) {
    const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
    if (weights.empty()) continue;
    evaluate(plain, a, parameters, Shapes::Values, shapes);
    const auto nodes = plain.nodes(a);
    for (std::size_t q = 0; q < weights.size(); ++q) {
      const Point3 v = field(model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]}));
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double share = weights[q] * shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i));
        sums.row(nodes[i]) += share * Eigen::RowVector4d(v[0], v[1], v[2], 1);
      }
    }
  }
  VectorXd coefficients(num_unknowns());
  const auto unknowns = space_->node_unknowns();
  for (std::size_t n = 0; n < unknowns.size(); ++n) {
    const auto row = sums.row(unknowns[n]);
    // Functions without mass in the rule: the field at their Greville point.
    const auto x = points_.row(static_cast<Eigen::Index>(n));
    const Point3 otherwise = row[3] > 0 ? Point3{} : field({x[0], x[1], x[2]});
    for (Eigen::Index d = 0; d < 3; ++d)
      coefficients[3 * static_cast<Eigen::Index>(n) + d] =
          row[3] > 0 ? row[d] / row[3] : otherwise[static_cast<std::size_t>(d)];
  }
  set_velocity(std::move(coefficients));
}

ForceReport ExplicitBody::evaluate_forces(double dt) {
  if (plain_) return forces_->evaluate(displacement.data(), dt, internal.data());
  multiply(space_->extension(), displacement.data(), full_u_.data());
  const ForceReport report = forces_->evaluate(full_u_.data(), dt, full_f_.data());
  multiply(transposed_, full_f_.data(), internal.data());
  return report;
}

StartStep ExplicitBody::start_step() const {
  StartStep start;
  if (const auto bound = element_bound(*space_, small_strain_, settings_.mass)) start.element_dt = 2 / bound->omega;
  try {
    const auto connectivity = connectivity_ ? connectivity_ : std::make_shared<const Connectivity>(*space_);
    constexpr double tolerance = 1e-3;
    const LargestEigenvalue largest =
        largest_eigenvalue(assemble_stiffness(*space_, connectivity, small_strain_), mass_, tolerance);
    start.omega = omega_safety * largest.omega;
    start.products = largest.products;
  } catch (const NumericalError&) {
    if (start.element_dt == 0) throw;
    start.omega = 2 / start.element_dt;
    start.by_lanczos = false;
  }
  start.dt = 2 / start.omega;
  return start;
}

VectorXd ExplicitBody::full_displacement() const {
  return space_->expand(displacement);
}

} // namespace iga::solve
