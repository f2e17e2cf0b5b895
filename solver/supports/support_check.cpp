#include "solver/supports/support_check.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>

namespace iga::solve {

namespace {

using Twist = Eigen::Matrix<double, 6, 1>; // velocity t at the body's centre, then ω · radius

// A motion is free where its mean square displacement along the fixed directions, per unit area of support, stays below
// this share of its own: a support of size r holds a body of size R to about (r / R)².
constexpr double free_below = 1e-11;
// Components of unit vectors below this are noise: normals of single precision mix free motions with held ones.
constexpr double small = 1e-4;

struct Body {
  double volume = 0, radius = 0, support_area = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> held = Eigen::Matrix<double, 6, 6>::Zero(); ///< ∫ (e · v)² dA over twists
  std::vector<std::string> names;                                         ///< of the run's bodies that it consists of
};

// A span belongs to the body of its nodes; one whose functions were all removed moves with none.
std::size_t body_of(const SystemBody& part, const Bodies& bodies, std::int64_t a) {
  const auto nodes = part.space->nodes(a);
  return nodes.empty() ? 0
                       : static_cast<std::size_t>(bodies.of_node[static_cast<std::size_t>(part.first_node + nodes[0])]);
}

std::vector<Body> measure(const BodySystem& system, const Bodies& bodies) {
  std::vector<Body> all(static_cast<std::size_t>(bodies.count));
  for (const SystemBody& part : system)
    for (std::int64_t a = 0; a < part.space->num_cells(); ++a) {
      auto& names = all[body_of(part, bodies, a)].names;
      if (names.empty() || names.back() != part.name) names.push_back(part.name);
    }
  const auto each = [&](auto&& use) {
    for (const SystemBody& part : system) {
      const TrimmedModel& model = part.space->model();
      for (std::size_t a = 0; a < model.cells.span.size(); ++a)
        for (std::int64_t q = model.points.offsets[a]; q < model.points.offsets[a + 1]; ++q) {
          const auto i = static_cast<std::size_t>(q);
          const double* u = model.points.parameters.data() + 3 * i;
          use(all[body_of(part, bodies, static_cast<std::int64_t>(a))],
              as_vector(model.grid.to_position({u[0], u[1], u[2]})), model.points.weights[i]);
        }
    }
  };
  each([](Body& body, const Eigen::Vector3d& x, double w) {
    body.volume += w;
    body.centre += w * x;
  });
  for (Body& body : all)
    if (body.volume > 0) body.centre /= body.volume;
  each([](Body& body, const Eigen::Vector3d& x, double) {
    body.radius = std::max(body.radius, (x - body.centre).norm());
  });
  return all;
}

/// What a point of a region holds: the sum of e eᵀ over its held directions e.
using HeldAt = std::function<Eigen::Matrix3d(const Point3& position, const Point3& normal)>;

void add_region(const SystemBody& part, const Bodies& bodies, const SurfaceRegion& region, const HeldAt& held_at,
                std::vector<Body>& all) {
  for (std::size_t s = 0; s < region.cells.size(); ++s) {
    const PointBatch batch = gather(part.space->model(), region, s);
    Body& body = all[body_of(part, bodies, batch.cell)];
    // Lines and points count like strips and patches of the body's size.
    const Extent extent = region.report.extent;
    const double width = std::pow(body.radius, extent == Extent::Surface ? 0 : extent == Extent::Line ? 1 : 2);
    for (std::size_t q = 0; q < batch.size(); ++q) {
      const double area = width * batch.weights[q];
      body.support_area += area;
      Eigen::Matrix<double, 6, 3> twist; // of a unit displacement along each axis there
      const Eigen::Vector3d arm = (as_vector(batch.positions[q]) - body.centre) / body.radius;
      for (Eigen::Index d = 0; d < 3; ++d)
        twist.col(d) << Eigen::Vector3d::Unit(d), arm.cross(Eigen::Vector3d::Unit(d));
      body.held += area * twist * held_at(batch.positions[q], batch.normals[q]) * twist.transpose();
    }
  }
}

HeldAt held_by(const PreparedSupport& support) {
  return [&support](const Point3& position, const Point3& normal) {
    const FixedDirections fixed = fixed_directions(support, normal, position);
    Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
    for (std::size_t d = 0; d < static_cast<std::size_t>(fixed.count); ++d)
      held += as_vector(fixed.direction[d]) * as_vector(fixed.direction[d]).transpose();
    return held;
  };
}

// However soft: the directions in which a spring has any stiffness.
HeldAt held_by(const PreparedSpring& spring) {
  return [&spring](const Point3&, const Point3& normal) -> Eigen::Matrix3d {
    const SymmetricEigen3 eigen = symmetric_eigen_3(spring.stiffness(normal));
    Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k)
      if (eigen.values[k] > 1e-12 * eigen.values[2]) held += eigen.vectors.col(k) * eigen.vectors.col(k).transpose();
    return held;
  };
}

// Orthonormal basis of the twists that nothing resists.
Eigen::MatrixXd free_twists(const Body& body) {
  if (!(body.support_area > 0)) return Eigen::MatrixXd::Identity(6, 6);
  const SymmetricEigen eigen = symmetric_eigen(body.held / body.support_area);
  Eigen::Index count = 0;
  while (count < 6 && eigen.values[count] < free_below) ++count;
  return eigen.vectors.leftCols(count);
}

// The same space with as many zeros as possible: reduced row echelon form of the transposed basis, rows of length one.
Eigen::MatrixXd plain_basis(const Eigen::MatrixXd& basis) {
  Eigen::MatrixXd rows = basis.transpose();
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < rows.cols() && row < rows.rows(); ++c) {
    Eigen::Index pivot = 0;
    if (rows.col(c).tail(rows.rows() - row).cwiseAbs().maxCoeff(&pivot) < small) continue;
    rows.row(row).swap(rows.row(row + pivot));
    rows.row(row) /= rows(row, c);
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
      if (r != row) rows.row(r) -= rows(r, c) * rows.row(row);
    ++row;
  }
  rows = rows.unaryExpr([](double v) { return std::abs(v) < small ? 0.0 : v; });
  rows.rowwise().normalize();
  return rows.transpose();
}

std::string text(Eigen::Vector3d v, double unit) {
  for (double& c : v)
    if (std::abs(c) < small * unit) c = 0; // no "-0" and no rounding in messages
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
}

std::vector<std::string> describe(const Body& body, const Eigen::MatrixXd& twists) {
  std::vector<std::string> motions;
  // Combinations without rotation are translations; what is orthogonal to them rotates.
  const RightSingular turning = right_singular(twists.bottomRows(3));
  const Eigen::Index rotations = (turning.values.array() > small).count();
  const Eigen::Index translations = twists.cols() - rotations;
  Eigen::MatrixXd along(3, 0);
  if (translations > 0) {
    along = plain_basis((twists * turning.vectors.rightCols(translations)).topRows(3));
    for (Eigen::Index k = 0; k < translations; ++k)
      motions.push_back(fmt::format("translation along {}", text(along.col(k), 1)));
  }
  if (rotations == 0) return motions;
  const Eigen::MatrixXd space = twists * turning.vectors.leftCols(rotations);
  const Eigen::MatrixXd axes = plain_basis(space.bottomRows(3));
  const Eigen::MatrixXd factors = least_squares(space.bottomRows(3), axes);
  for (Eigen::Index k = 0; k < rotations; ++k) {
    const Eigen::Vector3d axis = axes.col(k);
    const Eigen::Vector3d velocity = body.radius * (space * factors.col(k)).head(3); // at the centre, for ω = axis
    const Eigen::Vector3d through = body.centre + axis.cross(velocity);
    motions.push_back(fmt::format("rotation about the axis {} through {}", text(axis, 1), text(through, body.radius)));
  }
  return motions;
}

// Of the twists that each body has free, those combinations that leave springs between bodies without force; by body an
// orthonormal basis of its part in them.
void take_springs_between(const BodySystem& system, const Bodies& bodies, std::span<const PreparedSpring> springs,
                          const std::vector<Body>& all, std::vector<Eigen::MatrixXd>& twists) {
  Eigen::Index rank = 0, count = 0;
  for (const PreparedSpring& spring : springs) rank += spring.rows.rows();
  if (rank == 0) return;
  std::vector<Eigen::Index> first;
  for (const Eigen::MatrixXd& free : twists) {
    first.push_back(count);
    count += free.cols();
  }
  if (count == 0) return;
  const auto points = system.node_points();
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(system.num_unknowns(), count);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto b = static_cast<std::size_t>(bodies.of_node[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d arm = (points.row(i).transpose() - all[b].centre) / all[b].radius;
    for (Eigen::Index k = 0; k < twists[b].cols(); ++k)
      motions.block<3, 1>(3 * i, first[b] + k) =
          twists[b].col(k).head<3>() + Eigen::Vector3d(twists[b].col(k).tail<3>()).cross(arm);
  }
  Eigen::MatrixXd stretch = Eigen::MatrixXd::Zero(std::max(rank, count), count);
  Eigen::Index row = 0;
  for (const PreparedSpring& spring : springs)
    for (Eigen::Index k = 0; k < spring.rows.rows(); ++k) {
      const double size = spring.pull.col(k).norm(); // a soft spring holds as a stiff one does
      if (size > 0) stretch.row(row++) = Eigen::RowVectorXd(spring.rows.row(k) * motions) / size;
    }
  const RightSingular svd = right_singular(stretch);
  const Eigen::Index held = (svd.values.array() > std::sqrt(free_below)).count();
  const Eigen::MatrixXd free = svd.vectors.rightCols(count - held);
  for (std::size_t b = 0; b < twists.size(); ++b) {
    if (twists[b].cols() == 0) continue;
    const Eigen::MatrixXd part = free.middleRows(first[b], twists[b].cols());
    const SymmetricEigen eigen = symmetric_eigen(part * part.transpose());
    const Eigen::Index kept = (eigen.values.array() > free_below).count();
    twists[b] = (twists[b] * eigen.vectors.rightCols(kept)).eval();
  }
}

} // namespace

std::vector<std::string> free_rigid_motions(const BodySystem& system, const NodePattern& pattern,
                                            std::span<const SupportTerms> supports,
                                            std::span<const PreparedSpring> springs) {
  const Bodies bodies = separate_bodies(pattern);
  std::vector<Body> all = measure(system, bodies);
  for (std::size_t b = 0; b < system.size(); ++b)
    for (const PreparedSupport& support : supports[b].prepared)
      add_region(system[b], bodies, support.region, held_by(support), all);
  for (const PreparedSpring& spring : springs)
    if (spring.is_grounded()) add_region(system[spring.body], bodies, spring.region, held_by(spring), all);
  std::vector<Eigen::MatrixXd> free;
  for (const Body& body : all) free.push_back(free_twists(body));
  take_springs_between(system, bodies, springs, all, free);
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < all.size(); ++b) {
    const Eigen::MatrixXd& twists = free[b];
    if (twists.cols() == 0) continue;
    const std::string names = system.size() == 1 ? ""
                                                 : fmt::format(", {}'{}'", all[b].names.size() > 1 ? "tied: " : "",
                                                               fmt::join(all[b].names, "', '"));
    lines.push_back(fmt::format("body {} of {}{} (centre {}, volume {:.4g}) is free to move: {}", b + 1, all.size(),
                                names, text(all[b].centre, all[b].radius), all[b].volume,
                                fmt::join(describe(all[b], twists), ", ")));
  }
  return lines;
}

} // namespace iga::solve
