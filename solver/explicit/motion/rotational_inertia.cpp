#include "solver/explicit/motion/rotational_inertia.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double worth_a_warning = 0.02; // of the inertia: what the turn of a body is off by

template <class Visit> void for_each_point(const TrimmedModel& model, Visit&& visit) {
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* u = &model.points.parameters[3 * q];
    visit(model.points.weights[q], model.grid.to_position({u[0], u[1], u[2]}));
  }
}

// Of the mass with more passes; nothing where the body cannot have it.
std::optional<double> error_of_mass(const ExplicitBody& body, MassType type, const Eigen::Matrix3d& exact,
                                    const Point3& centre, const Point3& spin) {
  try {
    const SolutionSpace& space = body.space();
    const MassOperator mass =
        make_mass(type, space, std::make_shared<const Connectivity>(space), body.small_strain().density);
    return inertia_error(inertia_of_mass(mass, body.node_points(), centre), exact, spin);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

} // namespace

Point3 centre_of_mass(const TrimmedModel& model) {
  double volume = 0;
  Point3 sum{};
  for_each_point(model, [&](double weight, const Point3& x) {
    volume += weight;
    for (std::size_t d = 0; d < 3; ++d) sum[d] += weight * x[d];
  });
  return {sum[0] / volume, sum[1] / volume, sum[2] / volume};
}

Eigen::Matrix3d inertia_of_points(const TrimmedModel& model, double density, const Point3& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for_each_point(model, [&](double weight, const Point3& x) {
    const Point3 from_centre = minus(x, centre);
    const Eigen::Vector3d r(from_centre.data());
    sum += density * weight * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  });
  return sum;
}

Eigen::Matrix3d inertia_of_mass(const MassOperator& mass,
                                const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>& points,
                                const Point3& centre) {
  const Eigen::Vector3d c(centre.data());
  Eigen::Matrix<double, Eigen::Dynamic, 3> turns(mass.size(), 3), momenta(mass.size(), 3);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (Eigen::Index n = 0; n < points.rows(); ++n)
      turns.col(axis).segment<3>(3 * n) = Eigen::Vector3d::Unit(axis).cross(points.row(n).transpose() - c);
  mass.multiply(turns.data(), momenta.data(), 3);
  return turns.transpose() * momenta;
}

double inertia_error(const Eigen::Matrix3d& found, const Eigen::Matrix3d& exact, const Point3& axis) {
  const Eigen::Vector3d a(axis.data());
  if (!a.isZero(0)) return a.dot(found * a) / a.dot(exact * a) - 1;
  const Eigen::VectorXd e = symmetric_eigen(found - exact, exact).values;
  return std::abs(e[0]) > std::abs(e[2]) ? e[0] : e[2];
}

std::optional<std::string> inertia_warning(const ExplicitBody& body, const Point3& spin) {
  if (!body.mass().is_lumped()) return std::nullopt;
  const TrimmedModel& model = body.space().model();
  const Point3 centre = centre_of_mass(model);
  const Eigen::Matrix3d exact = inertia_of_points(model, body.small_strain().density, centre);
  if (!(exact.determinant() > 0)) return std::nullopt; // all points on one line
  const double error = inertia_error(inertia_of_mass(body.mass(), body.node_points(), centre), exact, spin);
  if (std::abs(error) <= worth_a_warning) return std::nullopt;
  const bool spins = spin != Point3{};
  std::string advice = "use smaller spans";
  for (const auto& [type, name] :
       {std::pair(MassType::TwoPass, "two-pass"), std::pair(MassType::ThreePass, "three-pass")})
    if (const auto better = error_of_mass(body, type, exact, centre, spin);
        better && std::abs(*better) < std::abs(error)) {
      advice = fmt::format("mass = \"{}\" gives {:+.2g} %; or use smaller spans", name, 100 * *better);
      break;
    }
  return fmt::format(
      "body '{}': its lumped mass has a rotational inertia that is off by {:+.3g} % {}: it turns as if it "
      "were {}; {}",
      body.settings().name, 100 * error, spins ? "about the axis of its spin" : "about its worst axis",
      error > 0 ? "larger" : "smaller", advice);
}

} // namespace iga::solve
