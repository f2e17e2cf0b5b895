#include "solver/mechanics/geometric_stiffness.hpp"

#include <cassert>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

struct WorkSpace {
  SpanShapes shapes;
  Eigen::MatrixXd gradients, forces; // (3 points × nodes): ∇N and w σ ∇N, the components of a point together
  Eigen::MatrixXd product;
};

Eigen::Matrix3d tensor(const double* s) {
  Eigen::Matrix3d sigma;
  sigma << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return sigma;
}

// work.product: Σ_q w ∇N_i · σ ∇N_j of one cell, lower triangle.
void cell_matrix(const SolutionSpace& space, std::int64_t a, std::span<const double> stress, WorkSpace& work) {
  const TrimmedModel& model = space.model();
  const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
  evaluate(space, a, parameters, Shapes::Gradients, work.shapes);
  const auto points = static_cast<Eigen::Index>(weights.size()), nodes = work.shapes.gradients.cols() / 3;
  work.gradients.resize(3 * points, nodes);
  work.forces.resize(3 * points, nodes);
  const auto first = static_cast<std::size_t>(model.points.offsets[static_cast<std::size_t>(a)]);
  for (Eigen::Index q = 0; q < points; ++q) {
    for (Eigen::Index i = 0; i < nodes; ++i)
      for (Eigen::Index d = 0; d < 3; ++d) work.gradients(3 * q + d, i) = work.shapes.gradients(q, 3 * i + d);
    const auto point = static_cast<std::size_t>(q);
    work.forces.middleRows<3>(3 * q).noalias() =
        weights[point] * tensor(&stress[6 * (first + point)]) * work.gradients.middleRows<3>(3 * q);
  }
  work.product.resize(nodes, nodes);
  work.product.triangularView<Eigen::Lower>() = work.gradients.transpose() * work.forces;
}

} // namespace

MassMatrix assemble_geometric_stiffness(const BodySystem& system,
                                        const std::shared_ptr<const Connectivity>& connectivity,
                                        std::span<const std::span<const double>> stress) {
  assert(stress.size() == system.size());
  MassMatrix K(connectivity);
  tbb::enumerable_thread_specific<WorkSpace> work_spaces;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SolutionSpace& space = *system[b].space;
    const auto& offsets = space.model().points.offsets;
    assert(stress[b].size() == 6 * space.model().points.weights.size());
    for_spans(connectivity->blocks[b], [&](std::int64_t a) {
      if (offsets[static_cast<std::size_t>(a)] == offsets[static_cast<std::size_t>(a) + 1]) return;
      WorkSpace& work = work_spaces.local();
      cell_matrix(space, a, stress[b], work);
      K.add(space.nodes(a), work.product, connectivity->first_node[b]);
    });
  }
  return K;
}

void add_blocks(const MassMatrix& A, const Eigen::Matrix3d& P, StiffnessMatrix& K, std::int64_t first_node,
                std::int64_t end_node) {
  const NodePattern& pattern = K.pattern();
  assert(A.pattern().num_pairs() == pattern.num_pairs());
  const auto entries = A.values();
  const auto values = K.values();
  tbb::parallel_for(first_node, end_node, [&](std::int64_t node) {
    const auto j = static_cast<std::size_t>(node);
    const auto first = static_cast<std::size_t>(pattern.offsets[j]),
               rows = static_cast<std::size_t>(pattern.offsets[j + 1]) - first;
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t a = 0; a < 3; ++a)
          values[9 * first + 3 * b * rows + 3 * r + a] +=
              entries[first + r] * P(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  });
}

void add_scaled(const StiffnessMatrix& L, double factor, StiffnessMatrix& K) {
  const auto from = L.values();
  const auto to = K.values();
  assert(from.size() == to.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, to.size(), 65536),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t k = range.begin(); k < range.end(); ++k) to[k] += factor * from[k];
                    });
  if (factor != 0) K.add_low_rank(L.low_rank(), factor * L.low_rank_weights());
}

} // namespace iga::solve
