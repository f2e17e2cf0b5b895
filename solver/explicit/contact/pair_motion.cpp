#include "solver/explicit/contact/pair_motion.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

Point3 mean_motion(const std::vector<std::int32_t>& nodes, const Eigen::VectorXd& now, const Eigen::VectorXd& then) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t i : nodes) sum += now.segment<3>(3 * i) - then.segment<3>(3 * i);
  sum /= static_cast<double>(std::max<std::size_t>(nodes.size(), 1));
  return {sum[0], sum[1], sum[2]};
}

/// Largest motion of a surface beside a common translation, bounded from its nodes.
double largest_motion(const MovingSurface& s, const Eigen::VectorXd& now, const Eigen::VectorXd& then,
                      const Point3& beside) {
  const Eigen::Vector3d w(beside[0], beside[1], beside[2]);
  double largest2 = 0;
  for (const std::int32_t i : s.nodes())
    largest2 = std::max(largest2, (now.segment<3>(3 * i) - then.segment<3>(3 * i) - w).squaredNorm() *
                                      (s.reach_of_node(i) * s.reach_of_node(i)));
  return std::sqrt(largest2);
}

Eigen::Vector3d vector_of(const Point3& x) {
  return {x[0], x[1], x[2]};
}

/// w + G (x - c).
struct AffineMotion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), translation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
};

Eigen::Vector3d mean_of(const std::vector<Point3>& x) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Point3& p : x) sum += vector_of(p);
  return sum / static_cast<double>(std::max<std::size_t>(x.size(), 1));
}

AffineMotion translation_of(const std::vector<Point3>& then, const std::vector<Point3>& now) {
  AffineMotion motion;
  motion.centre = mean_of(then);
  motion.translation = mean_of(now) - motion.centre;
  return motion;
}

/// Least squares over all vertices.
AffineMotion affine_motion_of(const std::vector<Point3>& then, const std::vector<Point3>& now) {
  AffineMotion motion = translation_of(then, now);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), moved = Eigen::Matrix3d::Zero();
  for (std::size_t v = 0; v < then.size(); ++v) {
    const Eigen::Vector3d x = vector_of(then[v]) - motion.centre;
    spread += x * x.transpose();
    moved += (vector_of(now[v]) - vector_of(then[v]) - motion.translation) * x.transpose();
  }
  // A closed surface spreads in all directions; the shift keeps a sheet from dividing by zero.
  spread.diagonal().array() += 1e-9 * spread.trace();
  if (spread.trace() > 0) motion.gradient = moved * spread.inverse();
  return motion;
}

double largest_residual(const AffineMotion& motion, const std::vector<Point3>& then, const std::vector<Point3>& now) {
  double largest2 = 0;
  for (std::size_t v = 0; v < then.size(); ++v) {
    const Eigen::Vector3d x = vector_of(then[v]);
    const Eigen::Vector3d r = vector_of(now[v]) - x - motion.translation - motion.gradient * (x - motion.centre);
    largest2 = std::max(largest2, r.squaredNorm());
  }
  return std::sqrt(largest2);
}

/// Positions of the first side, seen from a rigid second one.
std::vector<Point3> places(const PairSides& sides) {
  std::vector<Point3> x = sides.first->positions();
  if (sides.rigid)
    for (Point3& p : x) p = sides.rigid->to_body(p);
  return x;
}

} // namespace

void PairMotion::keep(const PairSides& sides) {
  first_displacement_ = *sides.first_displacement;
  if (sides.rigid)
    pose_ = sides.rigid->pose();
  else
    second_displacement_ = *sides.second_displacement;
}

void PairMotion::start(const PairSides& sides, double reach) {
  measured_ = 0;
  reach_ = reach;
  keep(sides);
  if (!sides.second) return;
  first_ = places(sides);
  if (!sides.rigid && !sides.is_self()) second_ = sides.second->positions();
}

double PairMotion::bound(const PairSides& sides) const {
  if (sides.rigid) {
    const Pose& pose = sides.rigid->pose();
    const Eigen::Vector3d way = pose.centre - pose_.centre;
    const double angle = std::abs(Eigen::AngleAxisd(pose.turn * pose_.turn.conjugate()).angle());
    const double swept = angle > 0 ? angle * reach_ : 0;
    return measured_ + swept +
           largest_motion(*sides.first, *sides.first_displacement, first_displacement_, {way[0], way[1], way[2]});
  }
  const Point3 w = mean_motion(sides.second->nodes(), *sides.second_displacement, second_displacement_);
  const double second = largest_motion(*sides.second, *sides.second_displacement, second_displacement_, w);
  const double first =
      sides.is_self() ? second : largest_motion(*sides.first, *sides.first_displacement, first_displacement_, w);
  return measured_ + first + second;
}

double PairMotion::measure(const PairSides& sides, double near) {
  const std::vector<Point3> now = places(sides);
  if (sides.rigid) {
    measured_ = largest_residual({}, first_, now);
  } else if (sides.is_self()) {
    const AffineMotion motion = affine_motion_of(first_, now);
    measured_ = 2 * largest_residual(motion, first_, now) + motion.gradient.norm() * near;
  } else {
    const AffineMotion motion = translation_of(second_, sides.second->positions());
    measured_ = largest_residual(motion, first_, now) + largest_residual(motion, second_, sides.second->positions());
  }
  keep(sides);
  return measured_;
}

} // namespace iga::solve
