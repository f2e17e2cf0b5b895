#include "solver/mechanics/rigid_modes.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Share of λ_scale up to which a Rayleigh quotient may be rounding: (1e-5 of the part's frequency)², while the first
// elastic mode of a slender part may lie at 1e-4 of λ_scale.
constexpr double free_energy = 1e-10;
// A motion that moves a constrained value by less than this share of what it moves unknowns is not constrained.
constexpr double free_constraint = 1e-9;

// Nodes that are joined pair by pair.
class Joined {
 public:
  explicit Joined(std::int64_t nodes) : parent_(static_cast<std::size_t>(nodes)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  void join(std::int32_t i, std::int32_t j) {
    const std::int32_t a = root(i), b = root(j);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  Bodies bodies() {
    Bodies bodies;
    bodies.of_node.resize(parent_.size());
    for (std::size_t j = 0; j < parent_.size(); ++j) {
      const auto first = static_cast<std::size_t>(root(static_cast<std::int32_t>(j)));
      bodies.of_node[j] = first == j ? static_cast<std::int32_t>(bodies.count++) : bodies.of_node[first];
    }
    return bodies;
  }

 private:
  std::int32_t root(std::int32_t i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      auto& up = parent_[static_cast<std::size_t>(i)];
      up = parent_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  std::vector<std::int32_t> parent_;
};

// An M-orthonormal basis of the span of V; directions without mass are dropped.
MatrixXd orthonormal(const MatrixXd& V, const MatrixXd& MV) {
  if (V.cols() == 0) return V;
  MatrixXd G = V.transpose() * MV;
  const VectorXd scale = G.diagonal().unaryExpr([](double g) { return g > 0 ? 1 / std::sqrt(g) : 0.0; });
  G = scale.asDiagonal() * G * scale.asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (G + G.transpose()));
  // A body that is a line has rotations without inertia, to rounding.
  const Index kept = (eigen.values.array() > 1e-12).count();
  const VectorXd root = eigen.values.tail(kept).cwiseSqrt().cwiseInverse();
  return V * (scale.asDiagonal() * eigen.vectors.rightCols(kept) * root.asDiagonal());
}

// Combinations of the columns of V that leave all constrained values alone.
MatrixXd unconstrained(const MatrixXd& V, const ConstraintMatrix* C) {
  if (!C || C->rows() == 0 || V.cols() == 0) return V;
  VectorXd reach(C->rows());
  for (Index r = 0; r < C->rows(); ++r) reach[r] = C->row(r).cwiseAbs().sum();
  const VectorXd inverse = reach.unaryExpr([](double v) { return v > 0 ? 1 / v : 0.0; });
  const MatrixXd W = inverse.asDiagonal() * (*C * V) / V.cwiseAbs().maxCoeff();
  // C V may have thousands of rows and few columns: its triangular factor has the same singular values.
  const RightSingular svd = right_singular(W.rows() >= W.cols() ? W : MatrixXd(W.transpose() * W));
  const double limit = W.rows() >= W.cols() ? free_constraint : free_constraint * free_constraint;
  const Index fixed = (svd.values.array() > limit).count();
  return V * svd.vectors.rightCols(V.cols() - fixed);
}

// What six motions do to one node, which lies at `arm` from their axes; in columns first … first + 5.
void move_node(MatrixXd& motions, Index node, Index first, const Eigen::Vector3d& arm) {
  for (Index d = 0; d < 3; ++d) {
    motions(3 * node + d, first + d) = 1;
    motions.block<3, 1>(3 * node, first + 3 + d) = Eigen::Vector3d::Unit(d).cross(arm);
  }
}

} // namespace

Bodies separate_bodies(const NodePattern& pattern) {
  Joined joined(pattern.num_nodes());
  for (std::size_t j = 0; j < static_cast<std::size_t>(pattern.num_nodes()); ++j)
    for (auto k = static_cast<std::size_t>(pattern.offsets[j]); k < static_cast<std::size_t>(pattern.offsets[j + 1]);
         ++k)
      joined.join(static_cast<std::int32_t>(j), pattern.rows[k]);
  return joined.bodies();
}

Bodies separate_bodies(const SolutionSpace& space) {
  Joined joined(space.num_nodes());
  for (std::int64_t a = 0; a < space.num_cells(); ++a)
    for (const std::int32_t node : space.nodes(a)) joined.join(space.nodes(a).front(), node);
  return joined.bodies();
}

MatrixXd rigid_motions(const BodySystem& system, const Bodies& bodies) {
  const auto points = system.node_points();
  Eigen::Matrix<double, Eigen::Dynamic, 3> middle = Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(bodies.count, 3);
  VectorXd nodes = VectorXd::Zero(bodies.count);
  for (Index i = 0; i < points.rows(); ++i) {
    middle.row(bodies.of_node[static_cast<std::size_t>(i)]) += points.row(i);
    nodes[bodies.of_node[static_cast<std::size_t>(i)]] += 1;
  }
  MatrixXd motions = MatrixXd::Zero(system.num_unknowns(), 6 * bodies.count);
  for (Index i = 0; i < points.rows(); ++i) {
    const Index body = bodies.of_node[static_cast<std::size_t>(i)];
    move_node(motions, i, 6 * body, (points.row(i) - middle.row(body) / nodes[body]).transpose());
  }
  return motions;
}

MatrixXd rigid_motions(const BodySystem& system, const Point3& centre) {
  const auto points = system.node_points();
  MatrixXd motions = MatrixXd::Zero(system.num_unknowns(), 6);
  for (Index i = 0; i < points.rows(); ++i) move_node(motions, i, 0, points.row(i).transpose() - as_vector(centre));
  return motions;
}

double lambda_scale(const BodySystem& system) {
  const auto points = system.node_points();
  const double diagonal = (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
  double slowest = std::numeric_limits<double>::infinity();
  for (const SystemBody& body : system) slowest = std::min(slowest, body.material.slowest_wave());
  return std::pow(std::numbers::pi * slowest / diagonal, 2);
}

FreeMotions free_motions(const StiffnessMatrix& K, const MassOperator& M, const ConstraintMatrix* constraints,
                         const MatrixXd& motions, double lambda_scale) {
  FreeMotions free;
  MatrixXd V = orthonormal(motions, columns_of(M, motions));
  V = unconstrained(V, constraints);
  if (V.cols() > 0) {
    const MatrixXd stiffness = V.transpose() * columns_of(K, V);
    const SymmetricEigen eigen = symmetric_eigen(0.5 * (stiffness + stiffness.transpose()));
    const Index count = (eigen.values.array() < free_energy * lambda_scale).count();
    V = (V * eigen.vectors.leftCols(count)).eval();
  }
  free.vectors = orthonormal(V, columns_of(M, V));
  free.mass_vectors = columns_of(M, free.vectors);
  free.lambda = free.vectors.cwiseProduct(columns_of(K, free.vectors)).colwise().sum().transpose();
  return free;
}

} // namespace iga::solve
