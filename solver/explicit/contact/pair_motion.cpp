#include "solver/explicit/contact/pair_motion.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

constexpr std::size_t chunk = 1024; // nodes or vertices whose sums one thread takes

/// Σ of(i), i = 0 … count - 1; the same for any number of threads.
template <class Sum, class Of> Sum sum_of(std::size_t count, const Sum& zero, const Of& of) {
  std::vector<Sum> parts(num_chunks(count, chunk), zero);
  for_chunks(count, chunk, [&](std::size_t c, std::size_t first, std::size_t last) {
    Sum sum = zero;
    for (std::size_t i = first; i < last; ++i) sum += of(i);
    parts[c] = sum;
  });
  Sum sum = zero;
  for (const Sum& part : parts) sum += part;
  return sum;
}

template <class Of> double largest_of(std::size_t count, const Of& of) {
  std::vector<double> parts(num_chunks(count, chunk), 0);
  for_chunks(count, chunk, [&](std::size_t c, std::size_t first, std::size_t last) {
    double largest = 0;
    for (std::size_t i = first; i < last; ++i) largest = std::max(largest, of(i));
    parts[c] = largest;
  });
  double largest = 0;
  for (const double part : parts) largest = std::max(largest, part);
  return largest;
}

Point3 mean_motion(const std::vector<std::int32_t>& nodes, const Eigen::VectorXd& now, const Eigen::VectorXd& then) {
  Eigen::Vector3d sum = sum_of(nodes.size(), Eigen::Vector3d::Zero().eval(), [&](std::size_t k) -> Eigen::Vector3d {
    return now.segment<3>(3 * nodes[k]) - then.segment<3>(3 * nodes[k]);
  });
  sum /= static_cast<double>(std::max<std::size_t>(nodes.size(), 1));
  return {sum[0], sum[1], sum[2]};
}

/// Largest motion of a surface beside a common translation, bounded from its nodes.
double largest_motion(const MovingSurface& s, const Eigen::VectorXd& now, const Eigen::VectorXd& then,
                      const Point3& beside) {
  const Eigen::Vector3d w(beside[0], beside[1], beside[2]);
  return std::sqrt(largest_of(s.nodes().size(), [&](std::size_t k) {
    const std::int32_t i = s.nodes()[k];
    return (now.segment<3>(3 * i) - then.segment<3>(3 * i) - w).squaredNorm() *
           (s.reach_of_node(i) * s.reach_of_node(i));
  }));
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
  return sum_of(x.size(), Eigen::Vector3d::Zero().eval(), [&](std::size_t v) { return vector_of(x[v]); }) /
         static_cast<double>(std::max<std::size_t>(x.size(), 1));
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
  using Both = Eigen::Matrix<double, 6, 3>;
  const Both sums = sum_of(then.size(), Both::Zero().eval(), [&](std::size_t v) {
    const Eigen::Vector3d x = vector_of(then[v]) - motion.centre;
    Both both;
    both.topRows<3>() = x * x.transpose();
    both.bottomRows<3>() = (vector_of(now[v]) - vector_of(then[v]) - motion.translation) * x.transpose();
    return both;
  });
  Eigen::Matrix3d spread = sums.topRows<3>();
  const Eigen::Matrix3d moved = sums.bottomRows<3>();
  // A closed surface spreads in all directions; the shift keeps a sheet from dividing by zero.
  spread.diagonal().array() += 1e-9 * spread.trace();
  if (spread.trace() > 0) motion.gradient = moved * spread.inverse();
  return motion;
}

double largest_residual(const AffineMotion& motion, const std::vector<Point3>& then, const std::vector<Point3>& now) {
  return std::sqrt(largest_of(then.size(), [&](std::size_t v) {
    const Eigen::Vector3d x = vector_of(then[v]);
    const Eigen::Vector3d r = vector_of(now[v]) - x - motion.translation - motion.gradient * (x - motion.centre);
    return r.squaredNorm();
  }));
}

/// Positions of the first side, seen from a rigid second one.
std::vector<Point3> places(const PairSides& sides) {
  const std::vector<Point3>& positions = sides.first->positions();
  if (!sides.rigid) return positions;
  std::vector<Point3> x(positions.size());
  for_indices(x.size(), chunk, [&](std::size_t v) { x[v] = sides.rigid->to_body(positions[v]); });
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
