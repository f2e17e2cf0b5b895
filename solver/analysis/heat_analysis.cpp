// The scalar problem on the nodes of the vector one: ∫ k ∇v·∇T - ∫ (k ∂n T) v - ∫ (k ∂n v)(T - T_D) + ∫ β v (T - T_D).
//
// β. Nitsche's matrix is positive definite for β ≥ 2 k Λ with Λ the largest of ∫_Γc (∂n T)² / Σ_e ∫_e |∇T|² / m_e over
// the patches of nitsche_parameters, which finds the same for elasticity. Take that of C = diag(1, 1, 1, ½, ½, ½),
// where σ = ε, and the displacements T e_d, d = 1 … 3: Σ_d e_d·σ(T e_d) n = 2 ∂n T, so that
//   (∂n T)² ≤ ¾ Σ_d |σ(T e_d) n|²,    Σ_d |ε(T e_d)|² = 2 |∇T|²,
// and Λ ≤ 1.5 Λ_elastic whatever the shape of the cut.
#include "solver/analysis/heat_analysis.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/in_order.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/supports/support_rows.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>

namespace iga::solve {

namespace {

using Eigen::Index;

constexpr double share_of_elastic = 1.5;
constexpr double largest_residual = 1e-8;

ElasticMaterial unit_material() {
  ElasticMaterial material;
  material.C.diagonal() << 1, 1, 1, 0.5, 0.5, 0.5;
  return material;
}

// ∂T/∂n of all shape functions at the points of a batch: (points × nodes).
Eigen::MatrixXd normal_slopes(const SpanShapes& shapes, const PointBatch& batch) {
  const Index n = shapes.gradients.cols() / 3;
  Eigen::MatrixXd slopes(shapes.gradients.rows(), n);
  for (Index q = 0; q < slopes.rows(); ++q) {
    const Point3& normal = batch.normals[static_cast<std::size_t>(q)];
    for (Index i = 0; i < n; ++i)
      slopes(q, i) = normal[0] * shapes.gradients(q, 3 * i) + normal[1] * shapes.gradients(q, 3 * i + 1) +
                     normal[2] * shapes.gradients(q, 3 * i + 2);
  }
  return slopes;
}

/// What a region adds to the system, cell by cell.
struct CellTerms {
  Eigen::MatrixXd matrix; ///< empty: none
  Eigen::VectorXd load;
};

class HeatProblem {
 public:
  HeatProblem(const RunSettings& run, const SolutionSpace& space, double conductivity)
      : run_(run), space_(space), k_(conductivity), connectivity_(std::make_shared<const Connectivity>(space)),
        K_(connectivity_), load_(Eigen::VectorXd::Zero(space.num_nodes())) {
    for (const HeatBoundary& boundary : run.heat) regions_.push_back(find_region(boundary));
    need_given_temperature();
  }

  void assemble() {
    assemble_conduction();
    nitsche();
    for (std::size_t b = 0; b < run_.heat.size(); ++b) add_boundary(b);
  }

  const MassMatrix& matrix() const { return K_; }
  const Eigen::VectorXd& load() const { return load_; }
  Eigen::VectorXd residual(const Eigen::VectorXd& T) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(3 * T.size()); // the matrix acts on three components alike
    for (Index i = 0; i < T.size(); ++i) all[3 * i] = T[i];
    const Eigen::VectorXd product = K_ * all;
    Eigen::VectorXd r = load_;
    for (Index i = 0; i < T.size(); ++i) r[i] -= product[3 * i];
    return r;
  }

  HeatReport report(std::size_t b, const Eigen::VectorXd& T) const {
    const HeatBoundary& boundary = run_.heat[b];
    HeatReport report;
    report.region = regions_[b].region.report;
    if (boundary.kind == HeatKind::Source) {
      measure_volume(boundary, T, report);
      return report;
    }
    const PreparedSupport& prepared = regions_[b];
    double area = 0;
    in_order(
        prepared.region.cells.size(),
        [&](std::size_t s) {
          SpanShapes shapes;
          const PointBatch batch = gather(space_.model(), prepared.region, s);
          evaluate(space_, batch.cell, batch.parameters, Shapes::Both, shapes);
          const Eigen::VectorXd local = local_of(batch.cell, T), value = shapes.values * local,
                                slope = normal_slopes(shapes, batch) * local;
          std::array<double, 3> sums{}; // area, ∫ T, power
          for (std::size_t q = 0; q < batch.size(); ++q) {
            const auto i = static_cast<Index>(q);
            double into = flux_of(b);
            if (boundary.kind == HeatKind::Convection) into = boundary.value * (boundary.ambient - value[i]);
            if (boundary.kind == HeatKind::Temperature)
              into = k_ * slope[i] - prepared.beta[s] * (value[i] - boundary.value);
            sums[0] += batch.weights[q];
            sums[1] += batch.weights[q] * value[i];
            sums[2] += batch.weights[q] * into;
          }
          return sums;
        },
        [&](std::size_t, const std::array<double, 3>& sums) {
          area += sums[0];
          report.temperature += sums[1];
          report.power += sums[2];
        });
    report.temperature /= area;
    return report;
  }

 private:
  // As a support that fixes all components, so that nitsche_parameters knows it.
  PreparedSupport find_region(const HeatBoundary& boundary) const {
    PreparedSupport prepared;
    if (boundary.kind == HeatKind::Source) return prepared;
    prepared.region = choose_region(space_.model(), boundary.region, fmt::format("heat '{}'", boundary.name));
    prepared.region.report.name = boundary.name;
    return prepared;
  }

  // Every mechanically separate piece needs a temperature or a convection.
  void need_given_temperature() const {
    const Bodies bodies = separate_bodies(connectivity_->pattern);
    std::vector<bool> known(static_cast<std::size_t>(bodies.count), false);
    const auto piece_of = [&](std::int64_t cell) {
      return static_cast<std::size_t>(bodies.of_node[static_cast<std::size_t>(space_.nodes(cell)[0])]);
    };
    for (std::size_t b = 0; b < run_.heat.size(); ++b) {
      const HeatKind kind = run_.heat[b].kind;
      if (kind != HeatKind::Temperature && kind != HeatKind::Convection) continue;
      for (const std::int64_t cell : regions_[b].region.cells)
        if (!space_.nodes(cell).empty()) known[piece_of(cell)] = true;
    }
    const auto open = std::find(known.begin(), known.end(), false);
    if (open == known.end()) return;
    throw InputError(
        fmt::format("nothing determines the temperature{}: fluxes and sources alone leave it open; add a [[heat]] with "
                    "temperature or convection{}",
                    known.size() > 1 ? fmt::format(" of piece {} of {}", open - known.begin() + 1, known.size()) : "",
                    known.size() > 1 ? " on each piece" : ""));
  }

  void assemble_conduction() {
    tbb::enumerable_thread_specific<Work> works;
    for_spans(connectivity_->blocks[0], [&](std::int64_t a) {
      Work& work = works.local();
      const auto [parameters, weights] = span_points(space_, a, work.storage);
      if (weights.empty()) return;
      evaluate(space_, a, parameters, Shapes::Gradients, work.shapes);
      const Index n = work.shapes.gradients.cols() / 3, m = work.shapes.gradients.rows();
      Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, n);
      const Eigen::VectorXd root = (k_ * Eigen::Map<const Eigen::ArrayXd>(weights.data(), m)).sqrt().matrix();
      for (Index d = 0; d < 3; ++d) {
        const Eigen::MatrixXd slope = root.asDiagonal() * work.shapes.gradients(Eigen::all, Eigen::seqN(d, n, 3));
        block.selfadjointView<Eigen::Lower>().rankUpdate(slope.transpose());
      }
      K_.add(space_.nodes(a), block);
    });
  }

  void nitsche() {
    std::vector<PreparedSupport*> held;
    for (std::size_t b = 0; b < run_.heat.size(); ++b)
      if (run_.heat[b].kind == HeatKind::Temperature) held.push_back(&regions_[b]);
    nitsche_parameters(space_, unit_material(), held);
    for (PreparedSupport* const prepared : held)
      for (double& beta : prepared->beta) beta *= share_of_elastic * k_;
  }

  double flux_of(std::size_t b) const {
    const HeatBoundary& boundary = run_.heat[b];
    return boundary.kind == HeatKind::Power ? boundary.value / regions_[b].region.report.area : boundary.value;
  }

  void add_boundary(std::size_t b) {
    const HeatBoundary& boundary = run_.heat[b];
    if (boundary.kind == HeatKind::Source) return add_source(boundary.value);
    const PreparedSupport& prepared = regions_[b];
    in_order(
        prepared.region.cells.size(), [&](std::size_t s) { return terms(b, s); },
        [&](std::size_t s, const CellTerms& cell) {
          const auto nodes = space_.nodes(prepared.region.cells[s]);
          if (cell.matrix.size() > 0) K_.add(nodes, cell.matrix);
          for (std::size_t r = 0; r < nodes.size(); ++r) load_[nodes[r]] += cell.load[static_cast<Index>(r)];
        });
  }

  CellTerms terms(std::size_t b, std::size_t s) const {
    const HeatBoundary& boundary = run_.heat[b];
    const PreparedSupport& prepared = regions_[b];
    const PointBatch batch = gather(space_.model(), prepared.region, s);
    SpanShapes shapes;
    const bool held = boundary.kind == HeatKind::Temperature;
    evaluate(space_, batch.cell, batch.parameters, held ? Shapes::Both : Shapes::Values, shapes);
    const Eigen::Map<const Eigen::VectorXd> w(batch.weights.data(), static_cast<Index>(batch.size()));
    const Eigen::MatrixXd weighted = w.asDiagonal() * shapes.values;
    CellTerms cell;
    cell.load = weighted.colwise().sum().transpose();
    if (held) {
      const double beta = prepared.beta[s];
      const Eigen::MatrixXd slopes = k_ * normal_slopes(shapes, batch), mixed = slopes.transpose() * weighted;
      cell.matrix = beta * shapes.values.transpose() * weighted - mixed - mixed.transpose();
      cell.load = boundary.value * (beta * cell.load - slopes.transpose() * w);
    } else if (boundary.kind == HeatKind::Convection) {
      cell.matrix = boundary.value * shapes.values.transpose() * weighted;
      cell.load *= boundary.value * boundary.ambient;
    } else {
      cell.load *= flux_of(b);
    }
    return cell;
  }

  void add_source(double source) {
    in_order(
        static_cast<std::size_t>(space_.num_cells()),
        [&](std::size_t a) {
          Work work;
          const auto [parameters, weights] = span_points(space_, static_cast<std::int64_t>(a), work.storage);
          evaluate(space_, static_cast<std::int64_t>(a), parameters, Shapes::Values, work.shapes);
          return Eigen::VectorXd(source * work.shapes.values.transpose() *
                                 Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Index>(weights.size())));
        },
        [&](std::size_t a, const Eigen::VectorXd& local) {
          const auto nodes = space_.nodes(static_cast<std::int64_t>(a));
          for (std::size_t r = 0; r < nodes.size(); ++r) load_[nodes[r]] += local[static_cast<Index>(r)];
        });
  }

  void measure_volume(const HeatBoundary& boundary, const Eigen::VectorXd& T, HeatReport& report) const {
    const TrimmedModel& model = space_.model();
    SpanShapes shapes;
    double volume = 0;
    for (std::int64_t a = 0; a < space_.num_cells(); ++a) {
      const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
      evaluate(space_, a, parameters, Shapes::Values, shapes);
      const Eigen::VectorXd value = shapes.values * local_of(a, T);
      for (std::size_t q = 0; q < weights.size(); ++q) {
        const Point3 x = model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
        volume += weights[q];
        report.temperature += weights[q] * value[static_cast<Index>(q)];
        report.region.centroid = plus(report.region.centroid, times(x, weights[q]));
      }
    }
    report.region.name = boundary.name;
    report.region.area = volume;
    report.region.centroid = times(report.region.centroid, 1 / volume);
    report.temperature /= volume;
    report.power = boundary.value * volume;
  }

  Eigen::VectorXd local_of(std::int64_t cell, const Eigen::VectorXd& T) const {
    const auto nodes = space_.nodes(cell);
    Eigen::VectorXd local(static_cast<Index>(nodes.size()));
    for (std::size_t r = 0; r < nodes.size(); ++r) local[static_cast<Index>(r)] = T[nodes[r]];
    return local;
  }

  struct Work {
    SpanShapes shapes;
    SpanPointStorage storage;
  };

  const RunSettings& run_;
  const SolutionSpace& space_;
  double k_;
  std::shared_ptr<const Connectivity> connectivity_;
  MassMatrix K_;
  Eigen::VectorXd load_;
  std::vector<PreparedSupport> regions_; // by [[heat]]
};

void find_extremes(const SolutionSpace& space, double conductivity, HeatSolution& solution) {
  const TrimmedModel& model = space.model();
  solution.least = std::numeric_limits<double>::infinity();
  solution.most = -solution.least;
  const auto look = [&](const std::vector<std::int64_t>& offsets, const std::vector<double>& parameters) {
    std::vector<std::int64_t> cells;
    for (std::int64_t a = 0; a < space.num_cells(); ++a)
      cells.insert(
          cells.end(),
          static_cast<std::size_t>(offsets[static_cast<std::size_t>(a) + 1] - offsets[static_cast<std::size_t>(a)]), a);
    const HeatSamples samples = sample_heat(space, conductivity, solution.temperature, cells, parameters);
    for (std::size_t q = 0; q < cells.size(); ++q) {
      const Point3 x = model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
      if (samples.temperature[q] < solution.least) {
        solution.least = samples.temperature[q];
        solution.least_at = x;
      }
      if (samples.temperature[q] > solution.most) {
        solution.most = samples.temperature[q];
        solution.most_at = x;
      }
    }
  };
  look(model.points.offsets, model.points.parameters);
  look(model.surface.quadrature.offsets, model.surface.quadrature.parameters);
}

ProbeResult recover_heat_probes(const SolutionSpace& space, double conductivity, const Eigen::VectorXd& T,
                                std::span<const Probe> probes, std::span<const LocatedPoint> located) {
  ProbeResult result;
  std::vector<std::int64_t> cells;
  std::vector<double> parameters;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    result.names.push_back(probes[k].name);
    result.positions.insert(result.positions.end(), located[k].position.begin(), located[k].position.end());
    cells.push_back(located[k].cell);
    parameters.insert(parameters.end(), located[k].parameter.begin(), located[k].parameter.end());
  }
  HeatSamples samples = sample_heat(space, conductivity, T, cells, parameters);
  result.fields.temperature = std::move(samples.temperature);
  result.fields.heat_flux = std::move(samples.flux);
  return result;
}

double need_conductivity(const RunSettings& run) {
  if (!run.material.conductivity)
    throw InputError(
        "material: the conductivity is missing; give conductivity (power/(length · temperature)) in [material], or a "
        "named material that has one");
  return *run.material.conductivity;
}

} // namespace

HeatSamples sample_heat(const SolutionSpace& space, double conductivity, const Eigen::VectorXd& temperature,
                        std::span<const std::int64_t> cells, std::span<const double> parameters) {
  HeatSamples samples{std::vector<double>(cells.size()), std::vector<double>(3 * cells.size())};
  std::vector<std::size_t> order(cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return cells[p] < cells[q]; });
  SpanShapes shapes;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    const std::int64_t cell = cells[order[first]];
    std::vector<double> at;
    for (last = first; last < order.size() && cells[order[last]] == cell; ++last)
      at.insert(at.end(), &parameters[3 * order[last]], &parameters[3 * order[last]] + 3);
    evaluate(space, cell, at, Shapes::Both, shapes);
    const auto nodes = space.nodes(cell);
    Eigen::VectorXd local(static_cast<Index>(nodes.size()));
    for (std::size_t r = 0; r < nodes.size(); ++r) local[static_cast<Index>(r)] = temperature[nodes[r]];
    const Eigen::VectorXd value = shapes.values * local;
    for (std::size_t i = first; i < last; ++i) {
      const auto q = static_cast<Index>(i - first);
      samples.temperature[order[i]] = value[q];
      for (Index d = 0; d < 3; ++d)
        samples.flux[3 * order[i] + static_cast<std::size_t>(d)] =
            -conductivity * shapes.gradients(q, Eigen::seqN(d, local.size(), 3)).dot(local);
    }
  }
  return samples;
}

HeatSolution run_heat(const RunSettings& run, const SolutionSpace& space) {
  HeatSolution solution;
  Stopwatch watch(solution.timings);
  const double conductivity = need_conductivity(run);
  if (run.heat.empty()) throw InputError("the run has no [[heat]]: give temperatures, fluxes, convection or sources");
  const std::vector<LocatedPoint> probes = locate_probes(space.model(), run.statics.probes);
  HeatProblem problem(run, space, conductivity);
  watch.stage("regions");
  show_stage(run.progress, "assembly");
  problem.assemble();
  watch.stage("assembly");
  show_stage(run.progress, "factorisation");
  const auto solver = factorise_mass(problem.matrix());
  solution.cost = solver->cost();
  watch.stage("factorisation");
  show_stage(run.progress, "solution");
  Eigen::VectorXd T = solver->solve(problem.load());
  T += solver->solve(problem.residual(T));
  const double size = problem.load().norm();
  solution.residual = problem.residual(T).norm() / (size > 0 ? size : 1);
  if (!(solution.residual < largest_residual))
    throw NumericalError(
        fmt::format("the temperatures could not be solved for: relative residual {:.2g} after refinement, "
                    "expected below {:.0e}; functions hold almost no material",
                    solution.residual, largest_residual));
  solution.temperature = std::move(T);
  watch.stage("solution");
  show_stage(run.progress, "fields");
  const Eigen::VectorXd coefficients = space.extension() * solution.temperature;
  solution.result.temperature.assign(coefficients.data(), coefficients.data() + coefficients.size());
  for (std::size_t b = 0; b < run.heat.size(); ++b) {
    const HeatReport report = problem.report(b, solution.temperature);
    solution.result.boundaries.push_back({run.heat[b].name, name_of(run.heat[b].kind), report.region.area,
                                          report.region.centroid, report.temperature, report.power});
    solution.balance += report.power;
    solution.largest_power = std::max(solution.largest_power, std::abs(report.power));
    solution.boundaries.push_back(report);
    for (const std::string& warning : region_warnings(report.region, fmt::format("heat '{}'", run.heat[b].name)))
      solution.warnings.push_back(warning);
  }
  solution.result.probes = recover_heat_probes(space, conductivity, solution.temperature, run.statics.probes, probes);
  find_extremes(space, conductivity, solution);
  watch.stage("fields");
  return solution;
}

} // namespace iga::solve
