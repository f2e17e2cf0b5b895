#include "solver/space/cylinder.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double largest_deviation = 0.01; // of the radius
// Between normals of facets and of the cylinder: a hexagon's touch it at 30°, a square is none.
constexpr double least_cosine = 0.8;
// Normals that take less than this share of the second direction are those of a flat face.
constexpr double flat = 1e-3;
constexpr int most_steps = 50;

std::vector<Vector3d> corners_of(const TrimmedModel& model, const SurfaceRegion& region) {
  std::vector<std::int32_t> vertices;
  for (const std::int64_t t : region.triangles) {
    const Triangle& corners = model.surface.mesh.triangles[static_cast<std::size_t>(t)];
    vertices.insert(vertices.end(), corners.begin(), corners.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Vector3d> points;
  points.reserve(vertices.size());
  for (const std::int32_t v : vertices)
    points.push_back(as_vector(model.surface.mesh.vertices[static_cast<std::size_t>(v)]));
  return points;
}

/// A cylinder on its way: columns of `frame` are two directions across the axis and the axis.
struct Guess {
  Matrix3d frame;
  Vector3d point;
  double radius = 0;
  Vector3d local(const Vector3d& x) const { return frame.transpose() * (x - point); }
  double distance(const Vector3d& x) const { return local(x).head<2>().norm() - radius; }
};

// The circle (x - a)² + (y - b)² = r² whose squared radii fit best (Kåsa 1976), seen along the axis.
void fit_circle(const std::vector<Vector3d>& points, Guess& guess) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(points.size()), 3), b(A.rows(), 1);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Vector3d y = guess.local(points[static_cast<std::size_t>(i)]);
    A.row(i) << 2 * y[0], 2 * y[1], 1;
    b(i, 0) = y.head<2>().squaredNorm();
  }
  const Eigen::MatrixXd x = least_squares(A, b);
  guess.point += guess.frame.leftCols<2>() * x.topRows(2);
  guess.radius = std::sqrt(std::max(0.0, x(2, 0) + x.topRows(2).squaredNorm()));
}

// One Gauss–Newton step: the axis moves by (a, b), tilts by (α, β) about the point, the radius grows. Returns the
// step's size relative to the radius.
double improve(const std::vector<Vector3d>& points, Guess& guess) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(points.size()), 5), b(A.rows(), 1);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Vector3d y = guess.local(points[static_cast<std::size_t>(i)]);
    const double rho = y.head<2>().norm();
    if (!(rho > 0)) return 0;
    const double u = y[0] / rho, v = y[1] / rho, z = y[2] / guess.radius;
    A.row(i) << -u, -v, -u * z, -v * z, -1;
    b(i, 0) = guess.radius - rho;
  }
  const Eigen::MatrixXd step = least_squares(A, b);
  guess.point += guess.frame.leftCols<2>() * step.topRows(2);
  const Vector3d axis = guess.frame.col(2) + guess.frame.leftCols<2>() * step.middleRows(2, 2) / guess.radius;
  guess.frame = Eigen::Quaterniond::FromTwoVectors(guess.frame.col(2), axis).toRotationMatrix() * guess.frame;
  guess.radius += step(4, 0);
  return step.norm() / guess.radius;
}

std::string at(const Point3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

// Of a unit vector: what single precision of the corners leaves is no direction.
std::string direction(Point3 v) {
  for (double& c : v)
    if (std::abs(c) < 1e-4) c = 0;
  return at(v);
}

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw InputError(
      fmt::format("{}: the region is no cylinder: {}; choose the face of a bore or a shaft alone", what, why));
}

Vector3d along_normals_least(const SurfaceRegion& region, const std::string& what) {
  Matrix3d spread = Matrix3d::Zero();
  for (std::size_t q = 0; q < region.weights.size(); ++q) {
    const Vector3d n = as_vector(region.normals[q]);
    spread += region.weights[q] * n * n.transpose();
  }
  const SymmetricEigen3 eigen = symmetric_eigen_3(spread);
  if (!(eigen.values[1] > flat * eigen.values[2])) refuse(what, "it is flat");
  return eigen.vectors.col(0);
}

} // namespace

Point3 Cylinder::radial(const Point3& x) const {
  const Point3 y = minus(x, point), across = minus(y, times(axis, dot(y, axis)));
  return times(across, 1 / norm(across));
}

std::string Cylinder::text() const {
  return fmt::format("{} of radius {:.6g} about the axis {} through {}; corners of facets lie within {:.2g} of it",
                     is_bore ? "bore" : "shaft", radius, direction(axis), at(point), deviation);
}

Cylinder fit_cylinder(const TrimmedModel& model, const SurfaceRegion& region, const std::string& what) {
  const std::vector<Vector3d> points = corners_of(model, region);
  Guess guess;
  guess.point = as_vector(region.report.centroid);
  guess.frame =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along_normals_least(region, what)).toRotationMatrix();
  fit_circle(points, guess);
  for (int step = 0; step < most_steps && guess.radius > 0; ++step)
    if (!(improve(points, guess) > 1e-14)) break;
  Cylinder cylinder;
  Eigen::Index largest = 0;
  guess.frame.col(2).cwiseAbs().maxCoeff(&largest);
  cylinder.axis =
      as_point(guess.frame.col(2)[largest] < 0 ? Vector3d(-guess.frame.col(2)) : Vector3d(guess.frame.col(2)));
  cylinder.radius = guess.radius;
  // The point of the axis nearest to the region's centroid.
  const Vector3d axis = guess.frame.col(2), centre = as_vector(region.report.centroid);
  cylinder.point = as_point(guess.point + axis * axis.dot(centre - guess.point));
  Point3 worst{};
  for (const Vector3d& x : points)
    if (const double off = std::abs(guess.distance(x)); !(off <= cylinder.deviation)) {
      cylinder.deviation = off;
      worst = as_point(x);
    }
  if (!(cylinder.deviation <= largest_deviation * cylinder.radius))
    refuse(what, fmt::format("its corner {} lies {:.4g} from the cylinder that fits best (radius {:.6g}, axis {}), "
                             "allowed are {:g} % of the radius",
                             at(worst), cylinder.deviation, cylinder.radius, direction(cylinder.axis),
                             100 * largest_deviation));
  double facing = 0;
  for (std::size_t q = 0; q < region.weights.size(); ++q) {
    const Point3 x =
        model.grid.to_position({region.parameters[3 * q], region.parameters[3 * q + 1], region.parameters[3 * q + 2]});
    const double cosine = dot(region.normals[q], cylinder.radial(x));
    facing += region.weights[q] * cosine;
    if (!(std::abs(cosine) >= least_cosine))
      refuse(what,
             fmt::format("at {} its normal is {:.0f} degrees away from that of the cylinder that fits best (radius "
                         "{:.6g}, axis {})",
                         at(x), std::acos(std::clamp(std::abs(cosine), 0.0, 1.0)) * 180 / std::numbers::pi,
                         cylinder.radius, direction(cylinder.axis)));
  }
  cylinder.is_bore = facing < 0;
  return cylinder;
}

} // namespace iga::solve
