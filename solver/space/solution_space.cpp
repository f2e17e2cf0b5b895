#include "solver/space/solution_space.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/space/light_functions.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

struct LocalSpace {
  std::vector<std::int32_t> nodes;
  Eigen::MatrixXd extension; // empty where the nodes are the span's own functions
};

// Coefficients of a cell's Bernstein functions from those of its B-splines, ((p + 1)³ × columns) in place.
void to_bernstein(const SplineGrid& grid, const Index3& span, Eigen::MatrixXd& rows) {
  Eigen::Index stride = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = grid.knots(static_cast<int>(d));
    const auto n = static_cast<Eigen::Index>(knots.degree()) + 1;
    Eigen::MatrixXd T(n, n);
    std::vector<double> weights(static_cast<std::size_t>(n));
    for (Eigen::Index k = 0; k < n; ++k) {
      bernstein_weights(knots, span[d], static_cast<int>(k), weights);
      T.row(k) = Eigen::Map<const Eigen::RowVectorXd>(weights.data(), n);
    }
    Eigen::MatrixXd line(n, rows.cols());
    for (Eigen::Index first = 0; first < rows.rows(); ++first) {
      if (first / stride % n != 0) continue;
      for (Eigen::Index k = 0; k < n; ++k) line.row(k) = rows.row(first + k * stride);
      line = (T * line).eval();
      for (Eigen::Index k = 0; k < n; ++k) rows.row(first + k * stride) = line.row(k);
    }
    stride *= n;
  }
  // What the large factors of the B-splines leave of zeros and ones.
  constexpr double rounding = 1e-9;
  rows = rows.unaryExpr([](double x) { return std::abs(x - std::round(x)) < rounding ? std::round(x) : x; });
}

} // namespace

SolutionSpace::SolutionSpace(const TrimmedModel& model, const LightTreatment& treatment)
    : model_(&model), treatment_(treatment) {
  if (!model.unknowns.empty() && treatment.threshold_with_gap_ends >= 0)
    treatment_.threshold = treatment.threshold_with_gap_ends;
  LightFunctionPlan plan = plan_light_functions(model, treatment_);
  warnings_ = std::move(plan.warnings);
  fictitious_ = std::move(plan.fictitious);
  num_light_ = static_cast<std::int64_t>(plan.slaves.size());

  const std::size_t num_unknowns = model.num_unknowns();
  std::vector<std::int32_t> slave_of(num_unknowns, -1), node_of(num_unknowns, -1);
  for (std::size_t s = 0; s < plan.slaves.size(); ++s)
    slave_of[static_cast<std::size_t>(plan.slaves[s].unknown)] = static_cast<std::int32_t>(s);
  for (std::size_t u = 0; u < num_unknowns; ++u)
    if (slave_of[u] < 0) {
      node_of[u] = static_cast<std::int32_t>(node_unknown_.size());
      node_unknown_.push_back(static_cast<std::int64_t>(u));
    }
  if (node_unknown_.empty())
    throw InputError(fmt::format("all {} functions are light (mass fraction below {:.3g}) and removed; lower the "
                                 "threshold or choose smaller spans",
                                 num_unknowns, treatment_.threshold));

  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t u = 0; u < num_unknowns; ++u) {
    const auto row = static_cast<std::int32_t>(u);
    if (node_of[u] >= 0)
      entries.emplace_back(row, node_of[u], 1.0);
    else
      for (const auto& [master, weight] : plan.slaves[static_cast<std::size_t>(slave_of[u])].masters)
        entries.emplace_back(row, node_of[static_cast<std::size_t>(master)], weight);
  }
  const auto num_nodes = static_cast<Eigen::Index>(node_unknown_.size());
  extension_.resize(static_cast<Eigen::Index>(num_unknowns), num_nodes);
  extension_.setFromTriplets(entries.begin(), entries.end());
  if (!model.unknowns.empty()) {
    const auto num_functions = static_cast<std::int32_t>(model.functions.number.size());
    entries.clear();
    for (std::int32_t f = 0; f < num_functions; ++f)
      model.for_terms(f, [&](std::int32_t unknown, double weight) { entries.emplace_back(f, unknown, weight); });
    Eigen::SparseMatrix<double, Eigen::RowMajor> rows(num_functions, static_cast<Eigen::Index>(num_unknowns));
    rows.setFromTriplets(entries.begin(), entries.end());
    unknown_extension_.swap(extension_);
    extension_ = rows * unknown_extension_;
  }
  // A function that is a node: its row has nothing else.
  std::vector<std::uint8_t> is_node(model.functions.number.size(), model.unknowns.empty());
  for (std::size_t u = 0; u < num_unknowns; ++u) {
    const std::int64_t f = model.function_of(u);
    if (f >= 0) is_node[static_cast<std::size_t>(f)] = node_of[u] >= 0;
  }

  const CellUnknowns cell_unknowns(model);
  std::vector<LocalSpace> local(model.num_cells());
  tbb::parallel_for(std::size_t{0}, local.size(), [&](std::size_t a) {
    const auto functions = model.functions_of(a);
    bool plain = true;
    auto& nodes = local[a].nodes;
    for (const std::int32_t f : functions) {
      plain = plain && is_node[static_cast<std::size_t>(f)] != 0;
      for (decltype(extension_)::InnerIterator it(extension_, static_cast<Eigen::Index>(f)); it; ++it)
        nodes.push_back(static_cast<std::int32_t>(it.col()));
    }
    if (plain) return;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    auto& E = local[a].extension;
    E.setZero(static_cast<Eigen::Index>(functions.size()), static_cast<Eigen::Index>(nodes.size()));
    const auto place = [&](std::int32_t node) {
      return std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
    };
    if (is_bernstein(static_cast<std::int64_t>(a))) {
      // Bernstein coefficients from the unknowns first: there the large factors of the B-splines cancel.
      const auto unknowns = cell_unknowns.of(a);
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(E.rows(), static_cast<Eigen::Index>(unknowns.size()));
      for (std::size_t f = 0; f < functions.size(); ++f)
        model.for_terms(functions[f], [&](std::int32_t unknown, double weight) {
          rows(static_cast<Eigen::Index>(f),
               std::lower_bound(unknowns.begin(), unknowns.end(), unknown) - unknowns.begin()) = weight;
        });
      to_bernstein(model.grid, model.grid.span_index(model.cells.span[a]), rows);
      for (std::size_t u = 0; u < unknowns.size(); ++u)
        for (decltype(extension_)::InnerIterator it(unknown_extension_, unknowns[u]); it; ++it)
          E.col(place(static_cast<std::int32_t>(it.col()))) += it.value() * rows.col(static_cast<Eigen::Index>(u));
      return;
    }
    for (std::size_t f = 0; f < functions.size(); ++f)
      for (decltype(extension_)::InnerIterator it(extension_, static_cast<Eigen::Index>(functions[f])); it; ++it)
        E(static_cast<Eigen::Index>(f), place(static_cast<std::int32_t>(it.col()))) = it.value();
  });

  offsets_.push_back(0);
  local_extensions_.emplace_back();
  for (auto& [nodes, E] : local) {
    nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
    offsets_.push_back(static_cast<std::int64_t>(nodes_.size()));
    local_extension_index_.push_back(0);
    if (E.rows() == 0) continue;
    local_extension_index_.back() = static_cast<std::int32_t>(local_extensions_.size());
    local_extensions_.push_back(std::move(E));
  }
}

// Golub & Welsch (1969).
Eigen::MatrixX2d gauss_rule(int n) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int k = 1; k < n; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  const SymmetricEigen eigen = symmetric_eigen(jacobi);
  Eigen::MatrixX2d rule(n, 2);
  rule.col(0) = (eigen.values.array() + 1) / 2;
  rule.col(1) = eigen.vectors.row(0).array().square();
  return rule;
}

CubeRule cube_rule(const std::array<int, 3>& n) {
  const Eigen::MatrixX2d rules[3] = {gauss_rule(n[0]), gauss_rule(n[1]), gauss_rule(n[2])};
  CubeRule cube;
  cube.points.resize(n[0] * n[1] * n[2], 3);
  for (Eigen::Index q = 0; q < cube.points.rows(); ++q) {
    const Eigen::Index place[3] = {q % n[0], q / n[0] % n[1], q / (n[0] * n[1])};
    double weight = 1;
    for (Eigen::Index d = 0; d < 3; ++d) {
      cube.points(q, d) = rules[d](place[d], 0);
      weight *= rules[d](place[d], 1);
    }
    cube.weights.push_back(weight);
  }
  return cube;
}

namespace {

// Adds tensor Gauss points of a whole span, their weights scaled by `share`.
void add_gauss_points(const SplineGrid& grid, std::int64_t span, double share, SpanPointStorage& storage) {
  const Box3 box = grid.span_box(grid.span_index(span));
  const auto p = grid.degree();
  const CubeRule cube = cube_rule({p[0] + 1, p[1] + 1, p[2] + 1});
  for (Eigen::Index q = 0; q < cube.points.rows(); ++q) {
    for (std::size_t d = 0; d < 3; ++d)
      storage.parameters.push_back(box.lower[d] +
                                   cube.points(q, static_cast<Eigen::Index>(d)) * (box.upper[d] - box.lower[d]));
    storage.weights.push_back(share * grid.span_volume() * cube.weights[static_cast<std::size_t>(q)]);
  }
}

} // namespace

bool replaces_points(const TrimmedModel& model, std::int64_t a, InteriorPoints interior) {
  return interior == InteriorPoints::Gauss && model.quadrature.interior_rule != "gauss" &&
         model.is_interior(static_cast<std::size_t>(a));
}

SpanPoints span_points(const SolutionSpace& space, std::int64_t a, SpanPointStorage& storage, InteriorPoints interior) {
  const TrimmedModel& model = space.model();
  const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
  const double share = space.fictitious_share(a);
  const bool replace = replaces_points(model, a, interior);
  if (share == 0 && !replace) return {parameters, weights};
  storage.parameters.clear();
  storage.weights.clear();
  if (!replace) {
    storage.parameters.assign(parameters.begin(), parameters.end());
    storage.weights.assign(weights.begin(), weights.end());
  }
  add_gauss_points(model.grid, model.cells.span[static_cast<std::size_t>(a)], replace ? 1 + share : share, storage);
  return {storage.parameters, storage.weights};
}

const Eigen::MatrixXd& SolutionSpace::local_extension(std::int64_t a) const {
  return local_extensions_[static_cast<std::size_t>(local_extension_index_[static_cast<std::size_t>(a)])];
}

Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> SolutionSpace::node_points() const {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(num_nodes(), 3);
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    const auto u = static_cast<std::size_t>(node_unknown_[static_cast<std::size_t>(n)]);
    const std::int64_t f = model_->function_of(u);
    Point3 x;
    if (f >= 0) {
      x = model_->grid.control_point(
          model_->grid.function_index(model_->functions.number[static_cast<std::size_t>(f)]));
    } else {
      const auto parameter = std::span(model_->unknowns.parameters).subspan(3 * u, 3);
      x = model_->grid.to_position({parameter[0], parameter[1], parameter[2]});
    }
    points.row(n) << x[0], x[1], x[2];
  }
  return points;
}

Eigen::VectorXd SolutionSpace::expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns) const {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Eigen::Map<const Rows> nodes(unknowns.data(), num_nodes(), 3);
  Eigen::VectorXd all(3 * extension_.rows());
  Eigen::Map<Rows>(all.data(), extension_.rows(), 3).noalias() = extension_ * nodes;
  return all;
}

} // namespace iga::solve
