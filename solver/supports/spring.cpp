#include "solver/supports/spring.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/in_order.hpp"
#include "solver/supports/average_motion.hpp"
#include "solver/supports/body_choice.hpp"

#include <fmt/format.h>
#include <tuple>

namespace iga::solve {

namespace {

Eigen::Matrix3d axes_of(const Rotation& frame) {
  Eigen::Matrix3d R;
  for (Eigen::Index r = 0; r < 3; ++r)
    for (Eigen::Index c = 0; c < 3; ++c) R(r, c) = frame[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return R;
}

/// A chosen region, line or point and the body that it belongs to.
std::pair<std::size_t, SurfaceRegion> choose(const BodySystem& system, const std::string& body,
                                             const RegionChoice& region, const PlaceChoice& place,
                                             const std::string& what) {
  const auto in_body = [&](std::size_t b) {
    const TrimmedModel& model = system[b].space->model();
    return place.given() ? choose_places(model, place, what) : choose_region(model, region, what);
  };
  const std::size_t b = chosen_body(system, body, what, in_body);
  return {b, in_body(b)};
}

// e · (motion of the first end - motion of the second), each as it moves at a place both share.
void connect(const BodySystem& system, const std::string& what, PreparedSpring& spring) {
  const Eigen::Vector3d a = as_vector(spring.region.report.centroid), b = as_vector(spring.other.report.centroid);
  Eigen::MatrixXd along; // (rank × 3): √k e
  RowMatrix first, second;
  if (spring.spring.total) {
    const Point3 middle = as_point(0.5 * (a + b));
    const auto motion = [&](std::size_t body, const SurfaceRegion& region) -> RowMatrix {
      const Eigen::MatrixXd move = moved_to(middle, region.report.centroid).topRows<3>();
      return RowMatrix(RowMatrix(move.sparseView()) * average_motion(system, body, region));
    };
    first = motion(spring.body, spring.region);
    second = motion(spring.other_body, spring.other);
    along = as_vector(*spring.spring.total).cwiseSqrt().asDiagonal() * axes_of(spring.spring.frame).transpose();
  } else {
    if (!((b - a).norm() > 0))
      throw InputError(
          fmt::format("{}: both ends lie at ({:.6g}, {:.6g}, {:.6g}), so that the line between them has no "
                      "direction; give stiffness = [kx, ky, kz] between two surfaces",
                      what, a[0], a[1], a[2]));
    first = mean_displacement(system, spring.body, spring.region);
    second = mean_displacement(system, spring.other_body, spring.other);
    along = std::sqrt(spring.spring.axial) * (b - a).normalized().transpose();
  }
  spring.rows = RowMatrix(along.sparseView()) * RowMatrix(first - second);
  spring.pull = along.transpose();
}

} // namespace

Eigen::Matrix3d PreparedSpring::stiffness(const Point3& n) const {
  if (spring.total) {
    const RegionReport& report = region.report;
    const double extent = report.extent == Extent::Surface ? report.area
                          : report.extent == Extent::Line  ? report.length
                                                           : 1;
    const Eigen::Matrix3d R = axes_of(spring.frame);
    return R * (as_vector(*spring.total) / extent).asDiagonal() * R.transpose();
  }
  const Eigen::Vector3d e = as_vector(n);
  return spring.tangential * Eigen::Matrix3d::Identity() + (spring.normal - spring.tangential) * e * e.transpose();
}

std::vector<PreparedSpring> prepare_springs(const BodySystem& system, std::span<const Spring> springs) {
  std::vector<PreparedSpring> all;
  for (const Spring& spring : springs) {
    const std::string what = fmt::format("spring '{}'", spring.name);
    PreparedSpring prepared;
    prepared.spring = spring;
    std::tie(prepared.body, prepared.region) = choose(system, spring.body, spring.region, spring.place, what);
    prepared.region.report.name = spring.name;
    prepared.region.report.body = system.name_among_several(prepared.body);
    if (spring.to) {
      const auto [body, other] =
          choose(system, spring.to->body, spring.to->region, spring.to->place, what + ", its other end 'to'");
      prepared.other_body = body;
      prepared.other = other;
      connect(system, what, prepared);
    }
    all.push_back(std::move(prepared));
  }
  return all;
}

void add_springs(const BodySystem& system, std::span<const PreparedSpring> springs, StiffnessMatrix& K) {
  for (const PreparedSpring& prepared : springs) {
    if (!prepared.is_grounded()) {
      K.add_low_rank(prepared.rows);
      continue;
    }
    const SystemBody& body = system[prepared.body];
    in_order(
        prepared.region.cells.size(),
        [&](std::size_t s) {
          const PointBatch batch = gather(body.space->model(), prepared.region, s);
          SpanShapes shapes;
          evaluate(*body.space, batch.cell, batch.parameters, Shapes::Values, shapes);
          const Eigen::Index n = shapes.values.cols();
          Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * n, 3 * n);
          for (std::size_t q = 0; q < batch.size(); ++q) {
            const Eigen::Matrix3d D = batch.weights[q] * prepared.stiffness(batch.normals[q]);
            const auto N = shapes.values.row(static_cast<Eigen::Index>(q));
            for (Eigen::Index j = 0; j < n; ++j)
              for (Eigen::Index i = 0; i < n; ++i) block.block<3, 3>(3 * i, 3 * j) += N[i] * N[j] * D;
          }
          return block;
        },
        [&](std::size_t s, const Eigen::MatrixXd& block) {
          K.add(body.space->nodes(prepared.region.cells[s]), block, static_cast<std::int32_t>(body.first_node));
        });
  }
}

void add_spring_stress(const BodySystem& system, std::span<const PreparedSpring> springs, const Eigen::VectorXd& u,
                       StiffnessMatrix& L) {
  for (const PreparedSpring& spring : springs) {
    if (spring.is_grounded() || spring.spring.total) continue;
    const Eigen::Vector3d line = as_vector(spring.other.report.centroid) - as_vector(spring.region.report.centroid);
    const Eigen::Vector3d e = line.normalized();
    const double tension = e.dot(-spring.pull * (spring.rows * u));
    if (tension == 0) continue;
    const Eigen::Matrix<double, 3, 2> across =
        symmetric_eigen_3(Eigen::Matrix3d(e * e.transpose())).vectors.leftCols<2>();
    const RowMatrix apart = mean_displacement(system, spring.body, spring.region) -
                            mean_displacement(system, spring.other_body, spring.other);
    L.add_low_rank(RowMatrix(Eigen::MatrixXd(across.transpose()).sparseView()) * apart,
                   Eigen::Vector2d::Constant(tension / line.norm()));
  }
}

std::vector<SpringForce> spring_forces(const BodySystem& system, std::span<const PreparedSpring> springs,
                                       const Eigen::VectorXd& u) {
  std::vector<SpringForce> all;
  for (const PreparedSpring& prepared : springs) {
    if (!prepared.is_grounded()) {
      const Eigen::VectorXd stretch = prepared.rows * u;
      const Point3 force = as_point(-prepared.pull * stretch);
      all.push_back({force, cross(prepared.region.report.centroid, force), 0.5 * stretch.squaredNorm()});
      continue;
    }
    const SystemBody& body = system[prepared.body];
    const Eigen::VectorXd own = system.part(u, prepared.body);
    SpringForce sum;
    SpanShapes shapes;
    for (std::size_t s = 0; s < prepared.region.cells.size(); ++s) {
      const PointBatch batch = gather(body.space->model(), prepared.region, s);
      const auto nodes = body.space->nodes(batch.cell);
      evaluate(*body.space, batch.cell, batch.parameters, Shapes::Values, shapes);
      for (std::size_t q = 0; q < batch.size(); ++q) {
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < nodes.size(); ++i)
          moved +=
              shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i)) * own.segment<3>(3 * nodes[i]);
        const Eigen::Vector3d force = -batch.weights[q] * (prepared.stiffness(batch.normals[q]) * moved);
        sum.force = plus(sum.force, as_point(force));
        sum.moment = plus(sum.moment, cross(batch.positions[q], as_point(force)));
        sum.energy -= 0.5 * force.dot(moved);
      }
    }
    all.push_back(sum);
  }
  return all;
}

} // namespace iga::solve
