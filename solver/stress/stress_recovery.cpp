#include "solver/stress/stress_recovery.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
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

/// Sum of w (ε - ε_h) : C (ε - ε_h) over points, and of |T ε - t|² over pieces of surface, of all fields. Normal
/// equations of the points come from the moments of their weights: their number does not matter.
struct StressRecovery::Equations {
  const StressRecovery* of;
  int degree;
  MatrixXd at;            ///< (points × monomials of degree - 1)
  Eigen::VectorXd weight; ///< (points)
  VoigtPolynomial wanted; ///< (points × 6), strains
  MatrixXd tractions;     ///< (3 pieces × fields), times the root of the piece's weight
  Eigen::VectorXd wanted_tractions;
  double traction_weight = 0; ///< sum over the pieces

  /// Lower triangle (fields × fields).
  MatrixXd normal_matrix() const {
    const EquilibratedPolynomials& p = of->polynomials_;
    MatrixXd N = MatrixXd::Zero(p.size(degree), p.size(degree));
    if (tractions.rows() > 0) N.selfadjointView<Eigen::Lower>().rankUpdate(tractions.transpose());
    const MatrixXd scaled = weight.cwiseSqrt().asDiagonal() * at;
    MatrixXd moments = MatrixXd::Zero(at.cols(), at.cols());
    moments.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
    moments.triangularView<Eigen::StrictlyUpper>() = moments.transpose();
    MatrixXd times;
    for (int k = 1; k <= degree; ++k) {
      const FieldStrains& stress = of->stresses_[static_cast<std::size_t>(k - 1)];
      const Index first = p.num_monomials(k - 2), count = stress[0].cols();
      for (std::size_t c = 0; c < 6; ++c) {
        times.noalias() = moments.bottomRows(at.cols() - first).middleCols(first, stress[c].rows()) * stress[c];
        for (int j = k; j <= degree; ++j) {
          const MatrixXd& strain = p.strains_of_degree(j)[c];
          N.block(p.size(j - 1), p.size(k - 1), strain.cols(), count).noalias() +=
              strain.transpose() * times.middleRows(p.num_monomials(j - 2) - first, strain.rows());
        }
      }
    }
    return N;
  }

  /// What a sum of the first fields leaves of the wanted strains and tractions.
  std::pair<VoigtPolynomial, Eigen::VectorXd> rest(const Eigen::VectorXd& factors) const {
    const VoigtPolynomial strain = of->polynomials_.strain(factors);
    return {wanted - at.leftCols(strain.rows()) * strain,
            wanted_tractions - tractions.leftCols(factors.size()) * factors};
  }

  /// Right-hand side of the first `count` fields for what is left.
  Eigen::VectorXd right_side(const std::pair<VoigtPolynomial, Eigen::VectorXd>& left, Index count) const {
    const EquilibratedPolynomials& p = of->polynomials_;
    Eigen::VectorXd b = tractions.leftCols(count).transpose() * left.second;
    const VoigtPolynomial moments = at.transpose() * (weight.asDiagonal() * left.first);
    for (int k = 1; p.size(k - 1) < count; ++k) {
      const FieldStrains& stress = of->stresses_[static_cast<std::size_t>(k - 1)];
      for (std::size_t c = 0; c < 6; ++c)
        b.segment(p.size(k - 1), stress[c].cols()).noalias() +=
            stress[c].transpose() *
            moments.col(static_cast<Index>(c)).segment(p.num_monomials(k - 2), stress[c].rows());
      if (k == degree) break;
    }
    return b;
  }
};

StressRecovery::StressRecovery(RecoveryProblem problem)
    : problem_(std::move(problem)), model_(&problem_.space->model()), polynomials_([&] {
        const auto p = model_->grid.degree();
        degree_ = std::min(*std::min_element(p.begin(), p.end()) + more_degrees, highest_degree);
        spread_ = degree_ == 1 + more_degrees ? linear_spread : usual_spread;
        return EquilibratedPolynomials(model_->grid, *problem_.material, degree_);
      }()) {
  for (int k = 1; k <= degree_; ++k) {
    const FieldStrains& strains = polynomials_.strains_of_degree(k);
    FieldStrains& stresses = stresses_.emplace_back();
    for (std::size_t c = 0; c < 6; ++c) {
      stresses[c].setZero(strains[c].rows(), strains[c].cols());
      for (std::size_t d = 0; d < 6; ++d)
        stresses[c] += problem_.material->C(static_cast<Index>(c), static_cast<Index>(d)) * strains[d];
    }
  }
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

StressRecovery::Equations StressRecovery::equations(const Plan& plan, const Samples& samples,
                                                    const LinearForce& force) const {
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
    if (near >= smallest_weight) rows.push_back({s, near * weight, source});
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
  const auto places = [](const std::vector<Row>& rows) {
    Eigen::MatrixX3d s(static_cast<Index>(rows.size()), 3);
    for (std::size_t r = 0; r < rows.size(); ++r) s.row(static_cast<Index>(r)) = as_vector(rows[r].s).transpose();
    return s;
  };
  const auto of_force = [&, factors = force.is_zero() ? VoigtPolynomial() : polynomials_.strain_of_force(force)](
                            const Eigen::MatrixX3d& s) {
    VoigtPolynomial strain = VoigtPolynomial::Zero(s.rows(), 6);
    if (factors.rows() > 0) strain = EquilibratedPolynomials::monomials(s, 2) * factors;
    return strain;
  };

  Equations e{this, plan.degree, {}, {}, {}, {}, {}};
  const Eigen::MatrixX3d inside = places(strains), outside = places(tractions);
  e.at = EquilibratedPolynomials::monomials(inside, plan.degree - 1);
  e.weight.resize(inside.rows());
  e.wanted = -of_force(inside);
  for (Index r = 0; r < inside.rows(); ++r) {
    const Row& row = strains[static_cast<std::size_t>(r)];
    e.weight[r] = row.weight;
    e.wanted.row(r) += Eigen::Map<const Voigt>(&samples.strains[6 * row.source]).transpose();
  }

  const auto owner_of = [&](std::size_t piece) {
    return std::upper_bound(known.offsets.begin(), known.offsets.end(), static_cast<std::int64_t>(piece)) -
           known.offsets.begin() - 1;
  };
  const Index m = outside.rows();
  e.wanted_tractions.resize(3 * m);
  VoigtPolynomial known_strain = of_force(outside);
  std::array<VoigtPolynomial, 3> of_strain; // (pieces × 6): a component of the traction is this times the strain
  for (VoigtPolynomial& one : of_strain) one.resize(m, 6);
  for (Index r = 0; r < m; ++r) {
    const Row& row = tractions[static_cast<std::size_t>(r)];
    const double root = std::sqrt(row.weight);
    const Eigen::Matrix<double, 3, 6> T =
        root * known.known[row.source] * traction_of_stress(known.normals[row.source]) * problem_.material->C;
    if (problem_.material->initial_strain)
      known_strain.row(r) -=
          problem_.material->initial_strain->at(owner_of(row.source), known.parameters[row.source]).row(0);
    const Eigen::Vector3d wanted = root * known.tractions[row.source] - T * known_strain.row(r).transpose();
    for (Index i = 0; i < 3; ++i) {
      of_strain[static_cast<std::size_t>(i)].row(r) = T.row(i);
      e.wanted_tractions[i * m + r] = wanted[i];
    }
    e.traction_weight += row.weight;
  }
  e.tractions.resize(3 * m, polynomials_.size(plan.degree));
  const FieldStrains of_fields = polynomials_.strains(outside, plan.degree);
  for (Index k = 0; k < e.tractions.cols(); ++k) // all components of a column while it is near
    for (Index i = 0; i < 3; ++i) {
      const VoigtPolynomial& T = of_strain[static_cast<std::size_t>(i)];
      e.tractions.col(k).segment(i * m, m) =
          T.col(0).cwiseProduct(of_fields[0].col(k)) + T.col(1).cwiseProduct(of_fields[1].col(k)) +
          T.col(2).cwiseProduct(of_fields[2].col(k)) + T.col(3).cwiseProduct(of_fields[3].col(k)) +
          T.col(4).cwiseProduct(of_fields[4].col(k)) + T.col(5).cwiseProduct(of_fields[5].col(k));
    }
  return e;
}

StressRecovery::Fit StressRecovery::fit(const Plan& plan, const Samples& samples) const {
  Fit fit;
  fit.centre = plan.centre;
  fit.force = force_about(plan.cell, plan.centre);
  const Equations e = equations(plan, samples, fit.force);
  MatrixXd N = e.normal_matrix();
  const Index fields = N.rows();
  Eigen::VectorXd scale(fields);
  for (Index k = 0; k < fields; ++k) scale[k] = N(k, k) > 0 ? 1 / std::sqrt(N(k, k)) : 0;
  N = (scale.asDiagonal() * N * scale.asDiagonal()).eval(); // the lower triangle, which is all that is read
  const auto p = model_->grid.degree();
  const Index followed = polynomials_.size(std::min(plan.degree, *std::min_element(p.begin(), p.end())));
  for (Index k = 0; k < fields; ++k) N(k, k) += k < followed ? rounding : ridge;
  // The factor of the first fields is the first part of the factor of all.
  const Eigen::LLT<MatrixXd> factor(N);
  const auto solve = [&](Index count) {
    const auto L = factor.matrixLLT().topLeftCorner(count, count).triangularView<Eigen::Lower>();
    std::optional<Eigen::LDLT<MatrixXd>> pivoted; // where rounding has made N indefinite
    if (factor.info() != Eigen::Success) pivoted.emplace(N.topLeftCorner(count, count));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(count);
    for (int step = 0; step < 3; ++step) { // refinement: what the products lost comes back
      Eigen::VectorXd b = scale.head(count).cwiseProduct(e.right_side(e.rest(x), count));
      if (pivoted)
        b = pivoted->solve(b).eval();
      else {
        L.solveInPlace(b);
        L.transpose().solveInPlace(b);
      }
      x += scale.head(count).cwiseProduct(b);
    }
    return x;
  };
  fit.fields = solve(fields);
  fit.lower = solve(polynomials_.size(std::max(plan.degree - 1, 1)));
  const auto [strains, tractions] = e.rest(fit.fields);
  if (strains.rows() > 0) {
    const double energy = (strains * problem_.material->C).cwiseProduct(strains).rowwise().sum().dot(e.weight);
    fit.misfit += share_of_strains * std::sqrt(effective_modulus(*problem_.material) * energy / e.weight.sum());
  }
  if (tractions.rows() > 0) fit.misfit += share_of_tractions * std::sqrt(tractions.squaredNorm() / e.traction_weight);
  return fit;
}

void StressRecovery::evaluate_at(const Fit& fit, const SamplePoints& points, std::span<const std::size_t> numbers,
                                 RecoveredStress& out) const {
  const auto n = static_cast<Index>(numbers.size());
  Eigen::MatrixX3d s(n, 3);
  for (Index r = 0; r < n; ++r) {
    const double* u = &points.parameters[3 * numbers[static_cast<std::size_t>(r)]];
    s.row(r) = as_vector(in_spans({u[0], u[1], u[2]}, fit.centre)).transpose();
  }
  const VoigtPolynomial higher = polynomials_.strain(fit.fields), lower = polynomials_.strain(fit.lower);
  const VoigtPolynomial of_force = fit.force.is_zero() ? VoigtPolynomial() : polynomials_.strain_of_force(fit.force);
  // Strain and what the highest degree changes, side by side.
  MatrixXd both = MatrixXd::Zero(std::max(higher.rows(), of_force.rows()), 12);
  both.topRightCorner(higher.rows(), 6) = higher;
  both.topRightCorner(lower.rows(), 6) -= lower;
  both.topLeftCorner(higher.rows(), 6) = higher;
  if (of_force.rows() > 0) both.topLeftCorner(of_force.rows(), 6) += of_force;
  both.leftCols<6>() = (both.leftCols<6>() * problem_.material->C).eval();
  both.rightCols<6>() = (both.rightCols<6>() * problem_.material->C).eval();
  int degree = 0;
  while (EquilibratedPolynomials::num_monomials(degree) < both.rows()) ++degree;
  const Eigen::Matrix<double, 12, Eigen::Dynamic> stresses =
      (EquilibratedPolynomials::monomials(s, degree) * both).transpose();
  for (Index r = 0; r < n; ++r) {
    const std::size_t at = numbers[static_cast<std::size_t>(r)];
    Voigt stress = stresses.col(r).head<6>();
    if (problem_.material->initial_strain)
      stress -= problem_.material->C *
                problem_.material->initial_strain->at(points.cell[at], std::span(&points.parameters[3 * at], 3))
                    .row(0)
                    .transpose();
    std::copy(stress.data(), stress.data() + 6, &out.stress[6 * at]);
    out.von_mises[at] = von_mises(stress);
    out.error[at] = von_mises(stresses.col(r).tail<6>()) + fit.misfit;
  }
}

void StressRecovery::make_fits(std::vector<std::int64_t> cells) {
  std::erase_if(cells, [&](std::int64_t cell) { return fits_.contains(cell); });
  for (std::size_t first = 0; first < cells.size(); first += plans_at_once) {
    const std::size_t count = std::min(plans_at_once, cells.size() - first);
    std::vector<Plan> plans(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) { plans[k] = plan(cells[first + k]); });
    const Samples samples = sample(plans);
    std::vector<Fit> fits(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) { fits[k] = fit(plans[k], samples); });
    for (std::size_t k = 0; k < count; ++k) fits_.emplace(cells[first + k], std::move(fits[k]));
  }
}

RecoveredStress StressRecovery::at(const SamplePoints& points) {
  std::vector<std::size_t> order(points.cell.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points.cell[a] < points.cell[b]; });
  std::vector<std::int64_t> cells;
  std::vector<std::size_t> first; // of each cell's points in the order
  for (std::size_t k = 0; k < order.size(); ++k)
    if (k == 0 || points.cell[order[k]] != cells.back()) {
      cells.push_back(points.cell[order[k]]);
      first.push_back(k);
    }
  first.push_back(order.size());
  make_fits(cells);
  RecoveredStress out;
  out.stress.resize(6 * points.cell.size());
  out.von_mises.resize(points.cell.size());
  out.error.resize(points.cell.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t k) {
    evaluate_at(fits_.at(cells[k]), points, std::span(order).subspan(first[k], first[k + 1] - first[k]), out);
  });
  return out;
}

} // namespace iga::solve
