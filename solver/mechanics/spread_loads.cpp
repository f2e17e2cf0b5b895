#include "solver/mechanics/spread_loads.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double largest_axial = 0.01; // of the force
// The second direction must hold this share of the first: an arc of 20° holds 0.01.
constexpr double least_arc = 1e-3;

/// use(position, weight) for all points of a region.
template <class Use> void for_points(const TrimmedModel& model, const SurfaceRegion& region, Use&& use) {
  for (std::size_t q = 0; q < region.weights.size(); ++q)
    use(model.grid.to_position({region.parameters[3 * q], region.parameters[3 * q + 1], region.parameters[3 * q + 2]}),
        region.weights[q]);
}

} // namespace

Eigen::Matrix3d turning_inertia(const TrimmedModel& model, const SurfaceRegion& region) {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for_points(model, region, [&](const Point3& x, double w) {
    const Eigen::Vector3d r = as_vector(minus(x, region.report.centroid));
    inertia += w * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  });
  return inertia;
}

TractionField spread_evenly(const TrimmedModel& model, const SurfaceRegion& region, const Point3& force,
                            const Point3& moment) {
  const Point3 a = times(force, 1 / region.report.area);
  const Point3 b = as_point(turning_inertia(model, region).inverse() * as_vector(moment));
  return [a, b, centre = region.report.centroid](const Point3& x, const Point3&) {
    return plus(a, cross(b, minus(x, centre)));
  };
}

TractionField bearing_pressure(const TrimmedModel& model, const SurfaceRegion& region, const Cylinder& cylinder,
                               const Point3& force, const std::string& what) {
  const double size = norm(force), along = dot(force, cylinder.axis);
  if (!(size > 0)) throw InputError(fmt::format("{}: the force is zero; give bearing = [fx, fy, fz]", what));
  if (std::abs(along) > largest_axial * size)
    throw InputError(fmt::format(
        "{}: {:.4g} of the bearing force {:.4g} acts along the axis ({:.4g}, {:.4g}, {:.4g}) of "
        "the {}, where nothing presses; give a force across the axis, and that part as a force "
        "or pressure on a shoulder",
        what, along, size, cylinder.axis[0], cylinder.axis[1], cylinder.axis[2], cylinder.is_bore ? "bore" : "shaft"));
  const Point3 across = minus(force, times(cylinder.axis, along));
  // The pressed half of a bore lies ahead of the force, that of a shaft behind it.
  const Point3 towards = cylinder.is_bore ? across : times(across, -1);
  const auto pressed = [cylinder, towards](const Point3& x) { return dot(cylinder.radial(x), towards) > 0; };
  // t = e (e · g) there, e away from the axis: along g the pressure goes with the cosine. On a whole half g is parallel
  // to the force; elsewhere it is turned so that the resultant is the force.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for_points(model, region, [&](const Point3& x, double w) {
    const Eigen::Vector3d e = as_vector(cylinder.radial(x));
    if (pressed(x)) spread += w * e * e.transpose();
  });
  const SymmetricEigen3 eigen = symmetric_eigen_3(spread);
  if (!(eigen.values[1] > least_arc * eigen.values[2]))
    throw InputError(
        fmt::format("{}: of the half that the force ({:.4g}, {:.4g}, {:.4g}) presses, the region holds {}; "
                    "check the direction of the force, or choose the whole {}",
                    what, force[0], force[1], force[2], eigen.values[2] > 0 ? "a narrow strip only" : "nothing",
                    cylinder.is_bore ? "bore" : "shaft"));
  // Along the axis `spread` is zero, and so is the force across it: any stiffness there will do.
  const Eigen::Vector3d axis = as_vector(cylinder.axis);
  const Eigen::Matrix3d regular = spread + eigen.values[2] * axis * axis.transpose();
  const Point3 g = as_point(regular.inverse() * as_vector(across));
  const Point3 axial = times(cylinder.axis, along / region.report.area);
  return [cylinder, pressed, g, axial](const Point3& x, const Point3&) {
    const Point3 e = cylinder.radial(x);
    return pressed(x) ? plus(axial, times(e, dot(e, g))) : axial;
  };
}

} // namespace iga::solve
