#include "solver/stress/stress_recovery.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tbb/parallel_for.h>
#include <unordered_set>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// All measured on plates with holes, cavities and thick cylinders of three spans per radius (README.md): fields of
// three degrees more than the spline's have the smallest errors; above 6 more fields cost and bring nothing.
constexpr int more_degrees = 3, highest_degree = 6;
// Weights exp(-spread s²) at a distance of s spans; degree 1 has one point a span and wants more of them.
constexpr double usual_spread = 2, linear_spread = 1.4, smallest_weight = 0.005;
// Of tractions against strains: 1 leaves noise at the surface, 10 makes far facets count too much.
constexpr double traction_share = 5;
// Cut cells of less material have strains of poor accuracy.
constexpr double well_filled = 0.2;
// Fewer equations than this for each field: more neighbours are taken, then fewer fields.
constexpr double enough_equations = 2;
// Fields that the splines cannot follow are held down by this share where nothing determines them.
constexpr double ridge = 1e-7, rounding = 1e-13;
// Estimated error: what the highest degree changes, and these shares of what the fit leaves, root mean square.
constexpr double share_of_strains = 0.3, share_of_tractions = 0.5;
constexpr std::size_t plans_at_once = 512;

// Zeros of the Bernoulli polynomial B_p on [0, 1], where derivatives of splines of degree p are most accurate, and
// weights that sum to 1.
std::vector<std::pair<double, double>> accurate_points(int p) {
  switch (p) {
  case 1:
    return {{0.5, 1}};
  case 2:
    return {{0.5 - std::sqrt(1.0 / 12), 0.5}, {0.5 + std::sqrt(1.0 / 12), 0.5}};
  case 3:
    return {{0, 0.25}, {0.5, 0.5}, {1, 0.25}};
  default: {
    const double t = std::sqrt(0.25 - std::sqrt(1.0 / 30)); // t⁴ - 2 t³ + t² = 1/30 about the middle
    return {{0.5 - t, 0.5}, {0.5 + t, 0.5}};
  }
  }
}

} // namespace

/// What the fit of a cell is made from.
struct StressRecovery::Plan {
  std::int64_t cell = 0;
  Point3 centre{};                 ///< knot space
  double spread = 0;               ///< of the weights
  double least_fraction = 0;       ///< of the cells that give strains
  int degree = 0;                  ///< of the fields
  std::vector<std::int32_t> cells; ///< ascending
  std::size_t equations = 0;
};

/// Strains at the data points of some cells.
struct StressRecovery::Samples {
  std::vector<std::int32_t> cells; ///< ascending
  std::vector<std::size_t> first;  ///< (cells + 1)
  std::vector<double> parameters, weights, strains;
};

struct StressRecovery::Fit {
  Point3 centre{};
  int degree = 0;
  LinearForce force;
  Eigen::VectorXd fields, lower; ///< coefficients; those of the fit of one degree less
  double misfit = 0;             ///< share of what it leaves of strains and tractions in the error, force/length²
};

StressRecovery::StressRecovery(RecoveryProblem problem)
    : problem_(std::move(problem)), model_(&problem_.space->model()), polynomials_([&] {
        const auto p = model_->grid.degree();
        degree_ = std::min(*std::min_element(p.begin(), p.end()) + more_degrees, highest_degree);
        spread_ = degree_ == 1 + more_degrees ? linear_spread : usual_spread;
        return EquilibratedPolynomials(model_->grid, *problem_.material, degree_);
      }()) {
  root_ = Eigen::LLT<VoigtMatrix>(problem_.material->C).matrixU();
  const double size = std::cbrt(model_->grid.span_volume());
  traction_weight_ = traction_share * size / (effective_modulus(*problem_.material) * model_->grid.span_volume());
  const auto p = model_->grid.degree();
  for (const auto& [w, weight_w] : accurate_points(p[2]))
    for (const auto& [v, weight_v] : accurate_points(p[1]))
      for (const auto& [u, weight_u] : accurate_points(p[0])) {
        whole_[0].insert(whole_[0].end(), {u, v, w});
        whole_[1].push_back(weight_u * weight_v * weight_w);
      }
  const auto& links = model_->links.cells;
  first_neighbour_.assign(model_->num_cells() + 1, 0);
  for (const std::int32_t cell : links) ++first_neighbour_[static_cast<std::size_t>(cell) + 1];
  std::partial_sum(first_neighbour_.begin(), first_neighbour_.end(), first_neighbour_.begin());
  neighbours_.resize(links.size());
  std::vector<std::size_t> next(first_neighbour_.begin(), first_neighbour_.end() - 1);
  for (std::size_t l = 0; l < links.size(); l += 2) {
    neighbours_[next[static_cast<std::size_t>(links[l])]++] = links[l + 1];
    neighbours_[next[static_cast<std::size_t>(links[l + 1])]++] = links[l];
  }
}

Point3 StressRecovery::in_spans(const Point3& u, const Point3& centre) const {
  const Point3 h = model_->grid.span_size();
  return {(u[0] - centre[0]) / h[0], (u[1] - centre[1]) / h[1], (u[2] - centre[2]) / h[2]};
}

// Cells of the block of spans about a cell that links within the block join with it: none across a gap.
std::vector<std::int32_t> StressRecovery::neighbourhood(std::int64_t cell, int rings) const {
  const auto span_of = [&](std::int64_t a) {
    return model_->grid.span_index(model_->cells.span[static_cast<std::size_t>(a)]);
  };
  const Index3 middle = span_of(cell);
  std::vector<std::int32_t> found{static_cast<std::int32_t>(cell)};
  std::unordered_set<std::int32_t> seen{found[0]};
  for (std::size_t next = 0; next < found.size(); ++next) {
    const auto a = static_cast<std::size_t>(found[next]);
    for (std::size_t k = first_neighbour_[a]; k < first_neighbour_[a + 1]; ++k) {
      const Index3 ijk = span_of(neighbours_[k]);
      bool near = true;
      for (std::size_t d = 0; d < 3; ++d) near = near && std::abs(ijk[d] - middle[d]) <= rings;
      if (near && seen.insert(neighbours_[k]).second) found.push_back(neighbours_[k]);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

void StressRecovery::data_points(std::int32_t cell, std::vector<double>& parameters,
                                 std::vector<double>& weights) const {
  const auto a = static_cast<std::size_t>(cell);
  if (model_->is_interior(a)) {
    const Box3 box = model_->grid.span_box(model_->grid.span_index(model_->cells.span[a]));
    for (std::size_t q = 0; q < whole_[1].size(); ++q) {
      for (std::size_t d = 0; d < 3; ++d)
        parameters.push_back(box.lower[d] + whole_[0][3 * q + d] * (box.upper[d] - box.lower[d]));
      weights.push_back(whole_[1][q]);
    }
    return;
  }
  const auto own = cell_parameters(*model_, cell);
  parameters.insert(parameters.end(), own.begin(), own.end());
  for (const double w : cell_weights(*model_, cell)) weights.push_back(w / model_->grid.span_volume());
}

// Volume forces, and what initial strains ε₀ do to the equations: div C ε = -b + div C ε₀, by central differences.
LinearForce StressRecovery::force_about(std::int64_t cell, const Point3& centre) const {
  LinearForce force;
  const auto& initial = problem_.material->initial_strain;
  if (!problem_.body_force && !initial) return force;
  constexpr double step = 0.25, reach = 0.5; // of a span
  const Point3 h = model_->grid.span_size();
  const auto moved = [&](Point3 u, std::size_t d, double by) {
    u[d] += by * h[d];
    return u;
  };
  const auto at = [&](const Point3& u) {
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    if (problem_.body_force) b = as_vector(problem_.body_force(model_->grid.to_position(u)));
    if (!initial) return b;
    for (std::size_t d = 0; d < 3; ++d) {
      const Voigt slope =
          problem_.material->C *
          (initial->at(cell, moved(u, d, step)) - initial->at(cell, moved(u, d, -step))).row(0).transpose() /
          (2 * step * h[d]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          b[i] -= slope[voigt_place[i][j]] * model_->grid.rotation()[static_cast<std::size_t>(j)][d];
    }
    return b;
  };
  force.constant = at(centre);
  for (std::size_t d = 0; d < 3; ++d)
    force.slope.col(static_cast<Index>(d)) = (at(moved(centre, d, reach)) - at(moved(centre, d, -reach))) / (2 * reach);
  // Rounding of differences of a constant force, or of a uniform temperature, is none.
  if (force.slope.norm() < 1e-9 * force.constant.norm()) force.slope.setZero();
  return force;
}

// Counts the equations that are near enough; true where there are enough for all fields.
bool StressRecovery::take(Plan& plan, double least_fraction, double spread) const {
  plan.least_fraction = least_fraction;
  plan.spread = spread;
  plan.equations = 0;
  const auto is_near = [&](const Point3& u) {
    const Point3 s = in_spans(u, plan.centre);
    return std::exp(-spread * dot(s, s)) >= smallest_weight;
  };
  std::vector<double> parameters, weights;
  for (const std::int32_t cell : plan.cells) {
    const auto a = static_cast<std::size_t>(cell);
    if (model_->cells.volume_fraction[a] >= least_fraction) {
      parameters.clear();
      data_points(cell, parameters, weights);
      for (std::size_t q = 0; q < parameters.size(); q += 3)
        if (is_near({parameters[q], parameters[q + 1], parameters[q + 2]})) plan.equations += 6;
    }
    const KnownTractions& known = problem_.tractions;
    for (std::int64_t k = known.offsets[a]; k < known.offsets[a + 1]; ++k)
      if (is_near(known.parameters[static_cast<std::size_t>(k)])) plan.equations += 3;
  }
  return static_cast<double>(plan.equations) >= enough_equations * static_cast<double>(polynomials_.size());
}

StressRecovery::Plan StressRecovery::plan(std::int64_t cell) const {
  Plan plan;
  plan.cell = cell;
  plan.centre = problem_.tractions.centres[static_cast<std::size_t>(cell)];
  plan.degree = degree_;
  plan.cells = neighbourhood(cell, 1);
  if (take(plan, well_filled, spread_)) return plan;
  plan.cells = neighbourhood(cell, 2);
  if (take(plan, well_filled, spread_ / 2) || take(plan, 0, spread_ / 2)) return plan;
  while (plan.degree > 1 &&
         static_cast<double>(plan.equations) < enough_equations * static_cast<double>(polynomials_.size(plan.degree)))
    --plan.degree;
  return plan;
}

StressRecovery::Samples StressRecovery::sample(const std::vector<Plan>& plans) const {
  Samples samples;
  for (const Plan& plan : plans)
    for (const std::int32_t cell : plan.cells)
      if (model_->cells.volume_fraction[static_cast<std::size_t>(cell)] >= plan.least_fraction)
        samples.cells.push_back(cell);
  std::sort(samples.cells.begin(), samples.cells.end());
  samples.cells.erase(std::unique(samples.cells.begin(), samples.cells.end()), samples.cells.end());
  samples.first = {0};
  SamplePoints points;
  for (const std::int32_t cell : samples.cells) {
    data_points(cell, points.parameters, samples.weights);
    points.cell.resize(samples.weights.size(), cell);
    samples.first.push_back(samples.weights.size());
  }
  samples.strains = sample_fields(*problem_.space, *problem_.material, points, problem_.unknowns, Fields::All).strain;
  samples.parameters = std::move(points.parameters);
  return samples;
}

StressRecovery::Fit StressRecovery::fit(const Plan& plan, const Samples& samples) const {
  struct Row {
    Point3 s;
    double weight;
    std::size_t source;
  };
  std::vector<Row> strains, tractions;
  const KnownTractions& known = problem_.tractions;
  const auto add = [&](std::vector<Row>& rows, const Point3& u, double weight, std::size_t source) {
    const Point3 s = in_spans(u, plan.centre);
    const double near = std::exp(-plan.spread * dot(s, s));
    if (near >= smallest_weight) rows.push_back({s, std::sqrt(near * weight), source});
  };
  for (const std::int32_t cell : plan.cells) {
    const auto a = static_cast<std::size_t>(cell);
    if (model_->cells.volume_fraction[a] >= plan.least_fraction) {
      const auto at = static_cast<std::size_t>(std::lower_bound(samples.cells.begin(), samples.cells.end(), cell) -
                                               samples.cells.begin());
      for (std::size_t q = samples.first[at]; q < samples.first[at + 1]; ++q)
        add(strains, {samples.parameters[3 * q], samples.parameters[3 * q + 1], samples.parameters[3 * q + 2]},
            samples.weights[q], q);
    }
    for (auto k = static_cast<std::size_t>(known.offsets[a]); k < static_cast<std::size_t>(known.offsets[a + 1]); ++k)
      add(tractions, known.parameters[k], known.areas[k] * traction_weight_, k);
  }
  const auto n = static_cast<Index>(strains.size()), m = static_cast<Index>(tractions.size());
  Eigen::MatrixX3d s(n + m, 3);
  Eigen::VectorXd weight(n + m);
  for (Index r = 0; r < n + m; ++r) {
    const Row& row = r < n ? strains[static_cast<std::size_t>(r)] : tractions[static_cast<std::size_t>(r - n)];
    s.row(r) = as_vector(row.s).transpose();
    weight[r] = row.weight;
  }
  FieldStrains of_fields = polynomials_.strains(s, plan.degree);
  for (MatrixXd& one : of_fields) one = weight.asDiagonal() * one;
  const Index fields = polynomials_.size(plan.degree);
  MatrixXd A(6 * n + 3 * m, fields);
  Eigen::VectorXd b(6 * n + 3 * m);
  const LinearForce force = force_about(plan.cell, plan.centre);
  const Eigen::Matrix<double, Eigen::Dynamic, 6> of_force =
      force.is_zero() ? Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(n + m, 6).eval()
                      : polynomials_.strains_of_force(s, force);
  for (Index k = 0; k < 6; ++k) { // root is upper triangular
    auto rows = A.middleRows(k * n, n);
    rows.setZero();
    for (Index j = k; j < 6; ++j) rows += root_(k, j) * of_fields[static_cast<std::size_t>(j)].topRows(n);
  }
  for (Index r = 0; r < n; ++r) {
    const Voigt wanted = Eigen::Map<const Voigt>(&samples.strains[6 * strains[static_cast<std::size_t>(r)].source]) -
                         of_force.row(r).transpose();
    const Voigt scaled = weight[r] * (root_ * wanted);
    for (Index k = 0; k < 6; ++k) b[k * n + r] = scaled[k];
  }
  const VoigtMatrix& C = problem_.material->C;
  const auto owner_of = [&](std::size_t piece) {
    return std::upper_bound(known.offsets.begin(), known.offsets.end(), static_cast<std::int64_t>(piece)) -
           known.offsets.begin() - 1;
  };
  MatrixXd of_point(6, fields);
  for (Index r = 0; r < m; ++r) {
    const std::size_t piece = tractions[static_cast<std::size_t>(r)].source;
    for (std::size_t k = 0; k < 6; ++k) of_point.row(static_cast<Index>(k)) = of_fields[k].row(n + r);
    const Eigen::Matrix<double, 3, 6> T = known.known[piece] * traction_of_stress(known.normals[piece]) * C;
    A.middleRows<3>(6 * n + 3 * r).noalias() = T * of_point;
    Voigt elastic = of_force.row(n + r).transpose();
    if (problem_.material->initial_strain)
      elastic -= problem_.material->initial_strain->at(owner_of(piece), known.parameters[piece]).row(0).transpose();
    b.segment<3>(6 * n + 3 * r) = weight[n + r] * (known.tractions[piece] - T * elastic);
  }
  MatrixXd N = MatrixXd::Zero(fields, fields);
  N.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose());
  Eigen::VectorXd scale(fields);
  for (Index k = 0; k < fields; ++k) scale[k] = N(k, k) > 0 ? 1 / std::sqrt(N(k, k)) : 0;
  N = (scale.asDiagonal() * N * scale.asDiagonal()).eval(); // the lower triangle, which is all that is read
  const auto p = model_->grid.degree();
  const Index followed = polynomials_.size(std::min(plan.degree, *std::min_element(p.begin(), p.end())));
  for (Index k = 0; k < fields; ++k) N(k, k) += k < followed ? rounding : ridge;
  const auto solve = [&](Index count) {
    const Eigen::LDLT<MatrixXd> factor(N.topLeftCorner(count, count));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(count);
    for (int step = 0; step < 3; ++step) { // refinement: what the products A ᵀA lost comes back
      const Eigen::VectorXd rest = A.leftCols(count).transpose() * (b - A.leftCols(count) * x);
      x += scale.head(count).cwiseProduct(factor.solve(scale.head(count).cwiseProduct(rest)));
    }
    return x;
  };
  Fit fit;
  fit.centre = plan.centre;
  fit.degree = plan.degree;
  fit.force = force;
  fit.fields = solve(fields);
  const Eigen::VectorXd rest = b - A * fit.fields;
  const auto mean_square = [](const auto& rows, const auto& weights) {
    return rows.size() > 0 ? rows.squaredNorm() / weights.squaredNorm() : 0;
  };
  fit.misfit = share_of_strains *
                   std::sqrt(effective_modulus(*problem_.material) * mean_square(rest.head(6 * n), weight.head(n))) +
               share_of_tractions * std::sqrt(mean_square(rest.tail(3 * m), weight.tail(m)));
  fit.lower = solve(polynomials_.size(std::max(plan.degree - 1, 1)));
  return fit;
}

void StressRecovery::evaluate_at(const Fit& fit, const SamplePoints& points, const std::vector<std::size_t>& numbers,
                                 RecoveredStress& out) const {
  const auto n = static_cast<Index>(numbers.size());
  Eigen::MatrixX3d s(n, 3);
  for (Index r = 0; r < n; ++r) {
    const double* u = &points.parameters[3 * numbers[static_cast<std::size_t>(r)]];
    s.row(r) = as_vector(in_spans({u[0], u[1], u[2]}, fit.centre)).transpose();
  }
  const FieldStrains of_fields = polynomials_.strains(s, fit.degree);
  Eigen::Matrix<double, Eigen::Dynamic, 6> strain = Eigen::Matrix<double, Eigen::Dynamic, 6>::Zero(n, 6), change(n, 6);
  if (!fit.force.is_zero()) strain = polynomials_.strains_of_force(s, fit.force);
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::VectorXd higher = of_fields[k] * fit.fields;
    strain.col(static_cast<Index>(k)) += higher;
    change.col(static_cast<Index>(k)) = higher - of_fields[k].leftCols(fit.lower.size()) * fit.lower;
  }
  if (problem_.material->initial_strain)
    for (Index r = 0; r < n; ++r) {
      const std::size_t at = numbers[static_cast<std::size_t>(r)];
      strain.row(r) -=
          problem_.material->initial_strain->at(points.cell[at], std::span(&points.parameters[3 * at], 3)).row(0);
    }
  for (Index r = 0; r < n; ++r) {
    const std::size_t at = numbers[static_cast<std::size_t>(r)];
    const Voigt stress = problem_.material->C * strain.row(r).transpose(),
                off = problem_.material->C * change.row(r).transpose();
    std::copy(stress.data(), stress.data() + 6, &out.stress[6 * at]);
    out.von_mises[at] = von_mises(stress);
    out.error[at] = von_mises(off) + fit.misfit;
  }
}

RecoveredStress StressRecovery::at(const SamplePoints& points) const {
  std::map<std::int64_t, std::vector<std::size_t>> of_cell;
  for (std::size_t k = 0; k < points.cell.size(); ++k) of_cell[points.cell[k]].push_back(k);
  std::vector<std::int64_t> cells;
  for (const auto& entry : of_cell) cells.push_back(entry.first);
  RecoveredStress out;
  out.stress.resize(6 * points.cell.size());
  out.von_mises.resize(points.cell.size());
  out.error.resize(points.cell.size());
  for (std::size_t first = 0; first < cells.size(); first += plans_at_once) {
    const std::size_t count = std::min(plans_at_once, cells.size() - first);
    std::vector<Plan> plans(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) { plans[k] = plan(cells[first + k]); });
    const Samples samples = sample(plans);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      evaluate_at(fit(plans[k], samples), points, of_cell.at(cells[first + k]), out);
    });
  }
  return out;
}

} // namespace iga::solve
