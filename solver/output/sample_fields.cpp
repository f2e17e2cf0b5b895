#include "solver/output/sample_fields.hpp"

#include <algorithm>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Points of one cell that are evaluated together; bounds the work space.
constexpr std::size_t most_points = 512;

struct Batch {
  std::int64_t cell;
  std::size_t first, last; ///< in the points sorted by cell
};

std::vector<std::size_t> sorted_by_cell(const SamplePoints& points) {
  std::vector<std::size_t> order(points.cell.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t p, std::size_t q) { return points.cell[p] < points.cell[q]; });
  return order;
}

std::vector<Batch> make_batches(const SamplePoints& points, const std::vector<std::size_t>& order) {
  std::vector<Batch> batches;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::int64_t cell = points.cell[order[i]];
    if (batches.empty() || batches.back().cell != cell || i - batches.back().first == most_points)
      batches.push_back({cell, i, i});
    batches.back().last = i + 1;
  }
  return batches;
}

struct WorkSpace {
  SpanShapes shapes;
  std::vector<double> parameters;
  MatrixXd coefficients;               ///< (nodes × 3 steps)
  MatrixXd displacement;               ///< (points × 3 steps)
  std::array<MatrixXd, 3> derivatives; ///< by x, y, z; as displacement
  Strains initial;                     ///< (points × 6), where the material has initial strains
};

// ∂N/∂x_d of all nodes: every third column of the gradients.
auto gradients_by(const SpanShapes& shapes, Index d) {
  const Index n = shapes.gradients.rows();
  return Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<>>(shapes.gradients.data() + d * n, n,
                                                             shapes.gradients.cols() / 3, Eigen::OuterStride<>(3 * n));
}

Voigt strain_at(const std::array<MatrixXd, 3>& by, Index q, Index step) {
  const Index x = 3 * step, y = x + 1, z = x + 2;
  Voigt strain;
  strain << by[0](q, x), by[1](q, y), by[2](q, z), by[1](q, x) + by[0](q, y), by[2](q, y) + by[1](q, z),
      by[0](q, z) + by[2](q, x);
  return strain;
}

class Sampler {
 public:
  Sampler(const SolutionSpace& space, const ElasticMaterial& material, const SamplePoints& points,
          const Eigen::Ref<const MatrixXd>& unknowns, Fields fields)
      : space_(space), material_(material), points_(points), unknowns_(unknowns), fields_(fields),
        order_(sorted_by_cell(points)) {
    const std::size_t n = points.cell.size() * static_cast<std::size_t>(unknowns.cols());
    out_.displacement.resize(3 * n);
    if (fields != Fields::Displacement) out_.von_mises.resize(n);
    if (fields == Fields::All) {
      out_.strain.resize(6 * n);
      out_.stress.resize(6 * n);
    }
  }

  FieldSamples run() {
    const auto batches = make_batches(points_, order_);
    tbb::enumerable_thread_specific<WorkSpace> spaces;
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) { sample(batches[b], spaces.local()); });
    return std::move(out_);
  }

 private:
  void sample(const Batch& batch, WorkSpace& work) {
    work.parameters.clear();
    for (std::size_t i = batch.first; i < batch.last; ++i)
      work.parameters.insert(work.parameters.end(), &points_.parameters[3 * order_[i]],
                             &points_.parameters[3 * order_[i]] + 3);
    evaluate(space_, batch.cell, work.parameters, fields_ == Fields::Displacement ? Shapes::Values : Shapes::Both,
             work.shapes);
    const auto nodes = space_.nodes(batch.cell);
    work.coefficients.resize(static_cast<Index>(nodes.size()), 3 * unknowns_.cols());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (Index step = 0; step < unknowns_.cols(); ++step)
        for (Index d = 0; d < 3; ++d)
          work.coefficients(static_cast<Index>(i), 3 * step + d) = unknowns_(3 * Index{nodes[i]} + d, step);
    work.displacement.noalias() = work.shapes.values * work.coefficients;
    if (fields_ != Fields::Displacement)
      for (std::size_t d = 0; d < 3; ++d)
        work.derivatives[d].noalias() = gradients_by(work.shapes, static_cast<Index>(d)) * work.coefficients;
    if (fields_ != Fields::Displacement && material_.initial_strain)
      work.initial = material_.initial_strain->at(batch.cell, work.parameters);
    for (std::size_t i = batch.first; i < batch.last; ++i)
      for (Index step = 0; step < unknowns_.cols(); ++step)
        store(order_[i], static_cast<Index>(i - batch.first), step, work);
  }

  void store(std::size_t point, Index q, Index step, const WorkSpace& work) {
    const std::size_t at = static_cast<std::size_t>(step) * points_.cell.size() + point;
    for (std::size_t d = 0; d < 3; ++d)
      out_.displacement[3 * at + d] = work.displacement(q, 3 * step + static_cast<Index>(d));
    if (fields_ == Fields::Displacement) return;
    const Voigt strain = strain_at(work.derivatives, q, step);
    Voigt elastic = strain;
    if (material_.initial_strain) elastic -= work.initial.row(q).transpose();
    const Voigt stress = material_.C * elastic;
    out_.von_mises[at] = von_mises(stress);
    if (fields_ != Fields::All) return;
    for (std::size_t c = 0; c < 6; ++c) {
      out_.strain[6 * at + c] = strain[static_cast<Index>(c)];
      out_.stress[6 * at + c] = stress[static_cast<Index>(c)];
    }
  }

  const SolutionSpace& space_;
  const ElasticMaterial& material_;
  const SamplePoints& points_;
  const Eigen::Ref<const MatrixXd>& unknowns_;
  Fields fields_;
  std::vector<std::size_t> order_;
  FieldSamples out_;
};

} // namespace

FieldSamples sample_fields(const SolutionSpace& space, const ElasticMaterial& material, const SamplePoints& points,
                           const Eigen::Ref<const MatrixXd>& unknowns, Fields fields) {
  return Sampler(space, material, points, unknowns, fields).run();
}

} // namespace iga::solve
