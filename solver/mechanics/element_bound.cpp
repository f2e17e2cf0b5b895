#include "solver/mechanics/element_bound.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/mechanics/assemble.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct WorkSpace {
  SpanShapes shapes;
  SpanPointStorage points;
  MatrixXd block, square;
  VectorXd scale;
};

// The sum of the parts must be K and M_L. Where a generalised rule is exact, Gauss points in every span have the same
// sum and no span's matrices are accidental; a reduced rule's K is the sum over its own points alone. Both bounds hold.
InteriorPoints bounding_points(const TrimmedModel& model) {
  return model.quadrature.interior_rule == "ggq" ? InteriorPoints::Gauss : InteriorPoints::Model;
}

// A = D K_e D with D = M_Le^(-1/2), whole and symmetric; false where a function has stiffness but no mass.
bool scaled_span(const SolutionSpace& space, const ElasticMaterial& material, std::int64_t a, WorkSpace& work) {
  const InteriorPoints interior = bounding_points(space.model());
  span_stiffness(space, a, material, work.shapes, work.block, interior);
  const auto [parameters, weights] = span_points(space, a, work.points, interior);
  evaluate(space, a, parameters, Shapes::Values, work.shapes);
  const VectorXd mass = material.density * work.shapes.values.transpose() *
                        Eigen::Map<const VectorXd>(weights.data(), static_cast<Index>(weights.size()));
  work.scale.resize(3 * mass.size());
  for (Index i = 0; i < mass.size(); ++i) {
    if (!(mass[i] > 0) && work.block.diagonal().segment<3>(3 * i).maxCoeff() > 0) return false;
    work.scale.segment<3>(3 * i).setConstant(mass[i] > 0 ? 1 / std::sqrt(mass[i]) : 0);
  }
  work.block = work.block.selfadjointView<Eigen::Lower>();
  work.block = (work.scale.asDiagonal() * work.block * work.scale.asDiagonal()).eval();
  return true;
}

// An upper bound of the largest eigenvalue of a positive semidefinite A from the norm of A⁸: (Σ λ¹⁶)^(1/16).
double quick_bound(const MatrixXd& A, MatrixXd& square) {
  const double norm = A.norm();
  if (!(norm > 0)) return 0;
  MatrixXd power = A / norm;
  double bound = norm, exponent = 1;
  for (int k = 0; k < 3; ++k) {
    square.noalias() = power * power;
    exponent /= 2;
    const double length = square.norm();
    bound *= std::pow(length, exponent);
    power = square / length;
  }
  return bound;
}

} // namespace

std::optional<ElementBound> element_bound(const SolutionSpace& space, const ElasticMaterial& material, MassType mass) {
  if (mass == MassType::Consistent || space.is_extended()) return {};
  std::vector<double> lambda(static_cast<std::size_t>(space.num_cells()), 0);
  std::atomic<double> largest{0};
  std::atomic<bool> massless{false};
  tbb::enumerable_thread_specific<WorkSpace> spaces;
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, space.num_cells(), 8), [&](const auto& range) {
    WorkSpace& work = spaces.local();
    for (std::int64_t a = range.begin(); a < range.end() && !massless; ++a) {
      if (cell_weights(space.model(), a).empty() && bounding_points(space.model()) == InteriorPoints::Model) continue;
      if (!scaled_span(space, material, a, work)) {
        massless = true;
        return;
      }
      // Spans that cannot hold the maximum are passed over; the one that does never is, whatever the order.
      if (quick_bound(work.block, work.square) < largest.load()) continue;
      const double own = symmetric_eigenvalues(work.block).maxCoeff();
      // Rounding of the dense solver.
      const double safe = own * (1 + 1e-12);
      lambda[static_cast<std::size_t>(a)] = safe;
      for (double seen = largest.load(); seen < safe && !largest.compare_exchange_weak(seen, safe);) {
      }
    }
  });
  if (massless) return {};
  const auto top = std::max_element(lambda.begin(), lambda.end());
  if (top == lambda.end()) return {};
  const int passes = mass == MassType::TwoPass ? 2 : mass == MassType::ThreePass ? 3 : 1;
  return ElementBound{std::sqrt(*top * passes), top - lambda.begin()};
}

std::optional<ElementBound> element_bound(const BodySystem& system, MassType mass) {
  std::optional<ElementBound> largest;
  for (std::size_t b = 0; b < system.size(); ++b) {
    auto bound = element_bound(*system[b].space, system[b].material, mass);
    if (!bound) return {};
    bound->body = b;
    if (!largest || bound->omega > largest->omega) largest = bound;
  }
  return largest;
}

} // namespace iga::solve
