#include "solver/supports/average_motion.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/spread_loads.hpp"

#include <Eigen/LU>

namespace iga::solve {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d R;
  R << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
  return R;
}

// Of all v + ω × r the one with the least ∫ |u - v - ω × r|²: v = ∫ u / area, ω = J⁻¹ ∫ r × u, r from the centroid.
RowMatrix average_motion(const BodySystem& system, std::size_t body, const SurfaceRegion& region) {
  const SystemBody& of = system[body];
  const TrimmedModel& model = of.space->model();
  const Eigen::Matrix3d inverse_inertia = turning_inertia(model, region).inverse();
  std::vector<Eigen::Triplet<double>> entries;
  SpanShapes shapes;
  for (std::size_t s = 0; s < region.cells.size(); ++s) {
    const PointBatch batch = gather(model, region, s);
    const auto nodes = of.space->nodes(batch.cell);
    evaluate(*of.space, batch.cell, batch.parameters, Shapes::Values, shapes);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      double mean = 0;
      Eigen::Vector3d arm = Eigen::Vector3d::Zero();
      for (std::size_t q = 0; q < batch.size(); ++q) {
        const double share =
            batch.weights[q] * shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i));
        mean += share;
        arm += share * as_vector(minus(batch.positions[q], region.report.centroid));
      }
      const Eigen::Matrix3d turn = inverse_inertia * cross_matrix(arm);
      const auto first = static_cast<int>(3 * (of.first_node + nodes[i]));
      for (int d = 0; d < 3; ++d) {
        entries.emplace_back(d, first + d, mean / region.report.area);
        for (int k = 0; k < 3; ++k) entries.emplace_back(3 + k, first + d, turn(k, d));
      }
    }
  }
  RowMatrix rows(6, system.num_unknowns());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

RowMatrix mean_displacement(const BodySystem& system, std::size_t body, const SurfaceRegion& region) {
  const SystemBody& of = system[body];
  double extent = 0;
  for (const double w : region.weights) extent += w;
  std::vector<Eigen::Triplet<double>> entries;
  SpanShapes shapes;
  for (std::size_t s = 0; s < region.cells.size(); ++s) {
    const PointBatch batch = gather(of.space->model(), region, s);
    const auto nodes = of.space->nodes(batch.cell);
    evaluate(*of.space, batch.cell, batch.parameters, Shapes::Values, shapes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t q = 0; q < batch.size(); ++q)
        for (int d = 0; d < 3; ++d)
          entries.emplace_back(d, static_cast<int>(3 * (of.first_node + nodes[i])) + d,
                               batch.weights[q] / extent *
                                   shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i)));
  }
  RowMatrix rows(3, system.num_unknowns());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Eigen::Matrix<double, 6, 6> moved_to(const Point3& place, const Point3& centroid) {
  Eigen::Matrix<double, 6, 6> move = Eigen::Matrix<double, 6, 6>::Identity();
  move.topRightCorner<3, 3>() = -cross_matrix(as_vector(minus(place, centroid))); // ω × r = -r × ω
  return move;
}

} // namespace iga::solve
