#include "solver/nonlinear/follower_pressure.hpp"

#include "solver/base/eigen_points.hpp"
#include "solver/base/in_order.hpp"

#include <Eigen/Dense>

namespace iga::solve {

namespace {

using Matrix3 = Eigen::Matrix3d;

Matrix3 cofactor(const Matrix3& F) {
  Matrix3 C;
  for (int b = 0; b < 3; ++b) C.col(b) = F.col((b + 1) % 3).cross(F.col((b + 2) % 3));
  return C;
}

/// Points of one cell of the region with F there.
struct CellPoints {
  PointBatch batch;
  SpanShapes shapes;
  std::vector<Matrix3> F;
};

CellPoints cell_points(const SolutionSpace& space, const SurfaceRegion& region, std::size_t s,
                       const Eigen::VectorXd& u) {
  CellPoints points{gather(space.model(), region, s), {}, {}};
  evaluate(space, points.batch.cell, points.batch.parameters, Shapes::Both, points.shapes);
  const auto nodes = space.nodes(points.batch.cell);
  for (std::size_t q = 0; q < points.batch.size(); ++q) {
    Matrix3 F = Matrix3::Identity();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      F += u.segment<3>(3 * static_cast<Eigen::Index>(nodes[i])) *
           points.shapes.gradients.row(static_cast<Eigen::Index>(q)).segment<3>(static_cast<Eigen::Index>(3 * i));
    points.F.push_back(F);
  }
  return points;
}

} // namespace

Point3 FollowerPressure::add_forces(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& f) const {
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  in_order(
      region_.cells.size(),
      [&](std::size_t s) {
        const CellPoints points = cell_points(*space_, region_, s, u);
        Eigen::MatrixXd forces(3, static_cast<Eigen::Index>(points.batch.size()));
        for (std::size_t q = 0; q < points.batch.size(); ++q)
          forces.col(static_cast<Eigen::Index>(q)) = -factor * pressure_ * points.batch.weights[q] *
                                                     (cofactor(points.F[q]) * as_vector(points.batch.normals[q]));
        const Eigen::MatrixXd nodal = forces * points.shapes.values;
        return nodal;
      },
      [&](std::size_t s, const Eigen::MatrixXd& nodal) {
        const auto nodes = space_->nodes(region_.cells[s]);
        for (std::size_t i = 0; i < nodes.size(); ++i)
          f.segment<3>(3 * static_cast<Eigen::Index>(nodes[i])) += nodal.col(static_cast<Eigen::Index>(i));
        total += nodal.rowwise().sum(); // the shape functions sum to 1
      });
  return as_point(total);
}

void FollowerPressure::subtract_stiffness(const Eigen::VectorXd& u, double factor, Tangent& A) const {
  in_order(
      region_.cells.size(),
      [&](std::size_t s) {
        const CellPoints points = cell_points(*space_, region_, s, u);
        const auto n = static_cast<Eigen::Index>(space_->nodes(points.batch.cell).size());
        Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * n, 3 * n);
        for (std::size_t q = 0; q < points.batch.size(); ++q) {
          const auto row = static_cast<Eigen::Index>(q);
          const Eigen::Vector3d normal = as_vector(points.batch.normals[q]);
          const Matrix3& F = points.F[q];
          // V[B](a, b) = ∂(cof F n)_a/∂F_bB = Σ n_A ε_abc ε_ABC F_cC = -ε_abc w_c.
          Matrix3 V[3];
          for (int B = 0; B < 3; ++B) {
            const int C1 = (B + 1) % 3, C2 = (B + 2) % 3;
            const Eigen::Vector3d w = normal[C1] * F.col(C2) - normal[C2] * F.col(C1);
            V[B] << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
          }
          const double scale = factor * pressure_ * points.batch.weights[q];
          for (Eigen::Index j = 0; j < n; ++j) {
            Matrix3 derivative = Matrix3::Zero();
            for (int B = 0; B < 3; ++B) derivative += points.shapes.gradients(row, 3 * j + B) * V[B];
            for (Eigen::Index i = 0; i < n; ++i)
              block.block<3, 3>(3 * i, 3 * j) += scale * points.shapes.values(row, i) * derivative;
          }
        }
        return block;
      },
      [&](std::size_t s, const Eigen::MatrixXd& block) { A.add(space_->nodes(region_.cells[s]), block); });
}

} // namespace iga::solve
