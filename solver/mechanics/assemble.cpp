#include "solver/mechanics/assemble.hpp"

#include "solver/base/eigen_points.hpp"
#include "solver/base/in_order.hpp"
#include "solver/space/tensor_gradients.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

struct WorkSpace {
  SpanShapes shapes;
  SpanPointStorage points;
  TensorPoints tensor;
  Eigen::MatrixXd weighted, product, block;
};

bool is_interior(const TrimmedModel& model, std::int64_t a) {
  return model.is_interior(static_cast<std::size_t>(a));
}

// G_ij = Σ_q w ∇N_i ∇N_jᵀ: all that a span's stiffness needs of its points, whatever the material. Lower triangle.
void gradient_products(const SolutionSpace& space, std::int64_t a, InteriorPoints interior, WorkSpace& work) {
  const auto [parameters, weights] = span_points(space, a, work.points, interior);
  evaluate(space, a, parameters, Shapes::Gradients, work.shapes);
  const Eigen::Map<const Eigen::ArrayXd> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
  work.weighted = work.shapes.gradients.array().colwise() * w.sqrt();
  work.product.setZero(work.weighted.cols(), work.weighted.cols());
  work.product.selfadjointView<Eigen::Lower>().rankUpdate(work.weighted.transpose());
}

// The elasticity tensor C_akbl, so that K_ij[a][b] = Σ_kl C_akbl G_ij[k][l].
class Elasticity {
 public:
  explicit Elasticity(const ElasticMaterial& material) {
    for (int a = 0; a < 3; ++a)
      for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 3; ++b)
          for (int l = 0; l < 3; ++l) C_[a][b](k, l) = material.C(voigt_place[a][k], voigt_place[b][l]);
    lambda_ = material.C(0, 1);
    mu_ = material.C(3, 3);
    VoigtMatrix isotropic = VoigtMatrix::Zero();
    isotropic.topLeftCorner<3, 3>().setConstant(lambda_);
    isotropic.diagonal() += (Voigt() << 2 * mu_, 2 * mu_, 2 * mu_, mu_, mu_, mu_).finished();
    is_isotropic_ = (material.C - isotropic).cwiseAbs().maxCoeff() <= 1e-14 * material.C.cwiseAbs().maxCoeff();
  }

  // Turns the lower triangle of G, block by block, into that of K.
  void apply(Eigen::MatrixXd& G) const {
    const Eigen::Index n = G.rows() / 3;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = j; i < n; ++i) {
        Eigen::Matrix3d g = G.block<3, 3>(3 * i, 3 * j);
        if (i == j) {
          g(0, 1) = g(1, 0);
          g(0, 2) = g(2, 0);
          g(1, 2) = g(2, 1);
        }
        G.block<3, 3>(3 * i, 3 * j) = block(g, i == j);
      }
  }

  // K_ij from a whole G_ij.
  Eigen::Matrix3d block(const Eigen::Matrix3d& g, bool on_diagonal) const {
    Eigen::Matrix3d k;
    if (is_isotropic_) {
      k = lambda_ * g + mu_ * g.transpose();
      k.diagonal().array() += mu_ * g.trace();
    } else {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) k(a, b) = C_[a][b].cwiseProduct(g).sum();
    }
    if (on_diagonal) k.triangularView<Eigen::StrictlyUpper>() = k.transpose().eval();
    return k;
  }

 private:
  Eigen::Matrix3d C_[3][3]; // C_[a][b](k, l)
  double lambda_ = 0, mu_ = 0;
  bool is_isotropic_ = false;
};

// work.product: the stiffness of a span, lower triangle. Interior spans' tensor points take the short way.
void span_matrix(const SolutionSpace& space, std::int64_t a, const Elasticity& elasticity, InteriorPoints interior,
                 WorkSpace& work) {
  const TrimmedModel& model = space.model();
  if (is_interior(model, a) && space.local_extension(a).size() == 0 &&
      as_tensor(span_points(space, a, work.points, interior), work.tensor)) {
    const GradientProducts products(model.grid, model.cells.span[static_cast<std::size_t>(a)], work.tensor);
    work.product.resize(3 * products.functions(), 3 * products.functions());
    products.for_pairs([&](Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& g) {
      work.product.block<3, 3>(3 * i, 3 * j) = elasticity.block(g, i == j);
    });
    return;
  }
  gradient_products(space, a, interior, work);
  elasticity.apply(work.product);
}

// Interior spans whose points lie alike and whose functions are alike have the same matrices: they are computed once.
// Positions in the span are told apart to 1e-9 of its size, far above rounding and far below any difference of rules.
struct SpanClasses {
  std::vector<std::int32_t> of_span;        // class of each active span, -1 where it stands alone
  std::vector<std::int64_t> representative; // first span of each class
};

constexpr double same_place = 1e-9;
// Generalised rules make thousands of classes. Only the matrices of the largest are kept: computing one anew is as fast
// as fetching it from memory, and memory stays bounded.
constexpr std::size_t most_classes = 64;

SpanClasses classify(const SolutionSpace& space, InteriorPoints interior) {
  const TrimmedModel& model = space.model();
  const SplineGrid& grid = model.grid;
  const Index3 extent = grid.spans();
  const auto p = grid.degree();
  std::vector<std::vector<std::int64_t>> keys(model.cells.span.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t s) {
    const auto a = static_cast<std::int64_t>(s);
    if (!is_interior(model, a)) return;
    if (space.local_extension(a).size() > 0 || space.fictitious_share(a) > 0) return;
    const Index3 ijk = grid.span_index(model.cells.span[s]);
    const Box3 box = grid.span_box(ijk);
    auto& key = keys[s];
    for (std::size_t d = 0; d < 3; ++d) // distance from the ends of the grid, as far as it changes the functions
      key.push_back(std::min<std::int64_t>(ijk[d], p[d] - 1) * 16 +
                    std::min<std::int64_t>(extent[d] - 1 - ijk[d], p[d] - 1));
    if (replaces_points(model, a, interior)) return; // the same points in all of them
    if (cell_weights(model, a).empty()) {            // nothing to share, and no product to take
      key.clear();
      return;
    }
    const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
    for (std::size_t q = 0; q < weights.size(); ++q) {
      for (std::size_t d = 0; d < 3; ++d)
        key.push_back(
            std::llround((parameters[3 * q + d] - box.lower[d]) / ((box.upper[d] - box.lower[d]) * same_place)));
      key.push_back(std::llround(weights[q] / (grid.span_volume() * same_place)));
    }
  });
  std::map<std::vector<std::int64_t>, std::int64_t> first_of; // first span of a key
  std::vector<std::int64_t> first(keys.size(), -1), members(keys.size(), 0);
  std::vector<std::int64_t> shared; // first spans of classes with more than one member
  for (std::size_t s = 0; s < keys.size(); ++s) {
    if (keys[s].empty()) continue;
    first[s] = first_of.try_emplace(std::move(keys[s]), static_cast<std::int64_t>(s)).first->second;
    if (++members[static_cast<std::size_t>(first[s])] == 2) shared.push_back(first[s]);
  }
  std::sort(shared.begin(), shared.end(), [&](std::int64_t x, std::int64_t y) {
    const std::int64_t m = members[static_cast<std::size_t>(x)], n = members[static_cast<std::size_t>(y)];
    return m != n ? m > n : x < y;
  });
  if (shared.size() > most_classes) shared.resize(most_classes);
  SpanClasses classes;
  classes.of_span.assign(keys.size(), -1);
  classes.representative = shared;
  for (std::size_t c = 0; c < shared.size(); ++c)
    classes.of_span[static_cast<std::size_t>(shared[c])] = static_cast<std::int32_t>(c);
  for (std::size_t s = 0; s < keys.size(); ++s)
    if (first[s] >= 0) classes.of_span[s] = classes.of_span[static_cast<std::size_t>(first[s])];
  return classes;
}

// Adds compute(span, work) → matrix of every span; once per class.
template <class Matrix, class Compute>
void add_spans(const SolutionSpace& space, const Connectivity& connectivity, std::size_t place, InteriorPoints interior,
               Matrix& matrix, Compute compute) {
  const SpanClasses classes = classify(space, interior);
  tbb::enumerable_thread_specific<WorkSpace> work_spaces;
  std::vector<Eigen::MatrixXd> shared(classes.representative.size());
  tbb::parallel_for(std::size_t{0}, shared.size(),
                    [&](std::size_t c) { shared[c] = compute(classes.representative[c], work_spaces.local()); });
  const auto& offsets = space.model().points.offsets;
  for_spans(connectivity.blocks[place], [&](std::int64_t a) {
    const auto s = static_cast<std::size_t>(a);
    // Generalised rules leave spans without points.
    if (offsets[s] == offsets[s + 1] && interior == InteriorPoints::Model && space.fictitious_share(a) == 0) return;
    const std::int32_t kind = classes.of_span[s];
    matrix.add(space.nodes(a), kind >= 0 ? shared[static_cast<std::size_t>(kind)] : compute(a, work_spaces.local()),
               connectivity.first_node[place]);
  });
}

} // namespace

StiffnessMatrix assemble_stiffness(const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity) {
  StiffnessMatrix K(connectivity);
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SolutionSpace& space = *system[b].space;
    const Elasticity elasticity(system[b].material);
    add_spans(space, *connectivity, b, InteriorPoints::Model, K,
              [&](std::int64_t a, WorkSpace& work) -> const Eigen::MatrixXd& {
                gradient_products(space, a, InteriorPoints::Model, work);
                elasticity.apply(work.product);
                return work.product;
              });
  }
  return K;
}

StiffnessMatrix assemble_stiffness(const SolutionSpace& space, const std::shared_ptr<const Connectivity>& connectivity,
                                   const ElasticMaterial& material) {
  return assemble_stiffness(BodySystem(space, material), connectivity);
}

MassMatrix assemble_mass(const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity) {
  MassMatrix M(connectivity);
  for (std::size_t b = 0; b < system.size(); ++b) {
    const SolutionSpace& space = *system[b].space;
    const double density = system[b].material.density;
    add_spans(space, *connectivity, b, InteriorPoints::Gauss, M,
              [&](std::int64_t a, WorkSpace& work) -> const Eigen::MatrixXd& {
                const auto [parameters, weights] = span_points(space, a, work.points, InteriorPoints::Gauss);
                evaluate(space, a, parameters, Shapes::Values, work.shapes);
                const Eigen::Map<const Eigen::ArrayXd> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
                work.weighted = work.shapes.values.array().colwise() * (density * w).sqrt();
                work.product.setZero(work.weighted.cols(), work.weighted.cols());
                work.product.selfadjointView<Eigen::Lower>().rankUpdate(work.weighted.transpose());
                return work.product;
              });
  }
  return M;
}

MassMatrix assemble_mass(const SolutionSpace& space, const std::shared_ptr<const Connectivity>& connectivity,
                         double density) {
  ElasticMaterial material;
  material.density = density;
  return assemble_mass(BodySystem(space, material), connectivity);
}

void span_stiffness(const SolutionSpace& space, std::int64_t a, const ElasticMaterial& material, SpanShapes& shapes,
                    Eigen::MatrixXd& block, InteriorPoints interior) {
  WorkSpace work;
  std::swap(work.shapes, shapes);
  span_matrix(space, a, Elasticity(material), interior, work);
  std::swap(work.shapes, shapes);
  block = std::move(work.product);
}

namespace {

// s_i = ∫ N_i dV; (num_nodes)
Eigen::VectorXd function_integrals(const SolutionSpace& space) {
  std::vector<Eigen::VectorXd> local(static_cast<std::size_t>(space.num_cells()));
  tbb::enumerable_thread_specific<WorkSpace> work_spaces;
  tbb::parallel_for(std::int64_t{0}, space.num_cells(), [&](std::int64_t a) {
    WorkSpace& work = work_spaces.local();
    const auto [parameters, weights] = span_points(space, a, work.points);
    evaluate(space, a, parameters, Shapes::Values, work.shapes);
    local[static_cast<std::size_t>(a)] =
        work.shapes.values.transpose() *
        Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  });
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(space.num_nodes());
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto nodes = space.nodes(a);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sums[nodes[i]] += local[static_cast<std::size_t>(a)][static_cast<Eigen::Index>(i)];
  }
  return sums;
}

} // namespace

Eigen::VectorXd lumped_mass(const SolutionSpace& space, double density) {
  return density * function_integrals(space);
}

Eigen::VectorXd body_force(const SolutionSpace& space, const Point3& b) {
  const Eigen::VectorXd integrals = function_integrals(space);
  Eigen::VectorXd f(space.num_unknowns());
  for (Eigen::Index n = 0; n < integrals.size(); ++n)
    for (Eigen::Index d = 0; d < 3; ++d) f[3 * n + d] = integrals[n] * b[static_cast<std::size_t>(d)];
  return f;
}

Eigen::VectorXd sum_over_cells(const SolutionSpace& space, const std::function<Eigen::MatrixXd(std::int64_t)>& nodal) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(space.num_unknowns());
  in_order(
      static_cast<std::size_t>(space.num_cells()), [&](std::size_t a) { return nodal(static_cast<std::int64_t>(a)); },
      [&](std::size_t a, const Eigen::MatrixXd& of_cell) {
        const auto nodes = space.nodes(static_cast<std::int64_t>(a));
        for (std::size_t r = 0; r < nodes.size(); ++r)
          f.segment<3>(3 * nodes[r]) += of_cell.col(static_cast<Eigen::Index>(r));
      });
  return f;
}

Eigen::VectorXd distributed_load(const SolutionSpace& space, const std::function<Point3(const Point3&)>& b) {
  const SplineGrid& grid = space.model().grid;
  return sum_over_cells(space, [&](std::int64_t a) {
    thread_local WorkSpace work;
    const auto [parameters, weights] = span_points(space, a, work.points);
    evaluate(space, a, parameters, Shapes::Values, work.shapes);
    Eigen::Matrix3Xd forces(3, static_cast<Eigen::Index>(weights.size()));
    for (std::size_t q = 0; q < weights.size(); ++q) {
      const Point3 x = grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
      forces.col(static_cast<Eigen::Index>(q)) = weights[q] * as_vector(b(x));
    }
    return Eigen::MatrixXd(forces * work.shapes.values);
  });
}

} // namespace iga::solve
