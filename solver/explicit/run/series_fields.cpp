#include "solver/explicit/run/series_fields.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/base/parallel.hpp"
#include "solver/explicit/kernel/mean_volume.hpp"
#include "solver/explicit/laws/law_access.hpp"
#include "solver/output/surface_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace iga::solve {

namespace {

using Matrix3 = Eigen::Matrix3d;

constexpr std::size_t cells = 16; // that one thread takes at a time

// N_i at the vertices of the surface, cell by cell.
Eigen::SparseMatrix<double, Eigen::RowMajor> vertex_rows(const SolutionSpace& space, const OutputMesh& output) {
  const std::size_t num_cells = space.model().num_cells();
  std::vector<std::vector<std::size_t>> owned(num_cells);
  for (std::size_t v = 0; v < output.cell.size(); ++v) owned[static_cast<std::size_t>(output.cell[v])].push_back(v);
  std::vector<std::vector<Eigen::Triplet<double>>> parts(num_cells);
  for_indices(num_cells, cells, [&](std::size_t a) {
    if (owned[a].empty()) return;
    std::vector<double> parameters;
    for (const std::size_t v : owned[a])
      parameters.insert(parameters.end(), &output.parameters[3 * v], &output.parameters[3 * v] + 3);
    SpanShapes shapes;
    evaluate(space, static_cast<std::int64_t>(a), parameters, Shapes::Values, shapes);
    const auto nodes = space.nodes(static_cast<std::int64_t>(a));
    for (std::size_t k = 0; k < owned[a].size(); ++k)
      for (std::size_t i = 0; i < nodes.size(); ++i)
        parts[a].emplace_back(static_cast<int>(owned[a][k]), nodes[i],
                              shapes.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)));
  });
  std::vector<Eigen::Triplet<double>> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows(static_cast<Eigen::Index>(output.cell.size()), space.num_nodes());
  rows.setFromTriplets(all.begin(), all.end());
  return rows;
}

double largest_log_strain(const Matrix3& F) {
  const Eigen::Vector3d squares = symmetric_eigenvalues_3(F.transpose() * F);
  double largest = 0;
  for (int d = 0; d < 3; ++d) {
    const double strain = 0.5 * std::log(std::max(squares[d], 1e-12)); // inverted points may lie flat
    if (std::abs(strain) > std::abs(largest)) largest = strain;
  }
  return largest;
}

double von_mises(const double* s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

// F of every quadrature point, (n × 9) row-major.
std::vector<double> deformation_gradients(const SolutionSpace& space, const Eigen::VectorXd& u) {
  const TrimmedModel& model = space.model();
  std::vector<double> F(9 * model.points.weights.size());
  for_indices(static_cast<std::size_t>(space.num_cells()), cells, [&](std::size_t cell) {
    const auto a = static_cast<std::int64_t>(cell);
    const auto parameters = cell_parameters(model, a);
    const auto first = static_cast<std::size_t>((parameters.data() - model.points.parameters.data()) / 3);
    if (parameters.empty()) return;
    SpanShapes shapes;
    evaluate(space, a, parameters, Shapes::Gradients, shapes);
    const auto nodes = space.nodes(a);
    for (std::size_t q = 0; q < parameters.size() / 3; ++q) {
      Matrix3 H = Matrix3::Identity();
      for (std::size_t i = 0; i < nodes.size(); ++i)
        for (int d = 0; d < 3; ++d)
          H.col(d) += u.segment<3>(3 * static_cast<Eigen::Index>(nodes[i])) *
                      shapes.gradients(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(3 * i) + d);
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> gradient(&F[9 * (first + q)]);
      gradient = H;
    }
  });
  return F;
}

// F-bar: what F of each quadrature point is scaled by for the law, as MeanVolumeLanes does it.
std::vector<double> mean_volume_scales(const SolutionSpace& space, const Eigen::VectorXd& u) {
  const TrimmedModel& model = space.model();
  std::vector<double> scales = deformation_gradients(space, u);
  for (std::size_t q = 0; q < scales.size() / 9; ++q)
    scales[q] = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&scales[9 * q]).determinant();
  scales.resize(scales.size() / 9);
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto parameters = cell_parameters(model, a);
    const auto first = static_cast<std::size_t>((parameters.data() - model.points.parameters.data()) / 3);
    const std::span J(scales.data() + first, parameters.size() / 3);
    double volume = 0, theta = 0;
    for (std::size_t q = 0; q < J.size(); ++q) {
      volume += model.points.weights[first + q];
      theta += model.points.weights[first + q] * J[q];
    }
    for (double& x : J) x = volume > 0 ? MeanVolumeLanes::scale(theta / volume, x) : 1;
  }
  return scales;
}

} // namespace

FieldSampler::FieldSampler(const TrimmedModel& model, const std::string& name, const Law& law, int subdivide)
    : law_(law), space_(model, {LightFunctions::None, 0}) {
  mesh_ = {name, space_.model().functions.number, subdivide_surface(space_.model(), subdivide)};
  rows_ = vertex_rows(space_, mesh_.surface);
}

FieldSampler::PointSamples FieldSampler::sample_points(const Eigen::VectorXd& u, const PointHistory& saved,
                                                       std::span<const std::int64_t> points,
                                                       std::span<const double> scales) const {
  std::vector<double> F = deformation_gradients(space_, u);
  const std::size_t n = F.size() / 9;
  if (!scales.empty())
    for (std::size_t k = 0; k < F.size(); ++k) F[k] *= scales[k / 9];
  const LawAccess law = std::visit([](const auto& own) { return access(own); }, law_);
  PointSamples samples{std::vector<double>(6 * n), std::vector<double>(n),
                       std::vector<double>(law.plastic_strain >= 0 ? n : 0)};
  const std::size_t num_blocks = points.size() / lanes;
  const std::size_t extra =
      num_blocks > 0 ? saved.extra.size() / (lanes * num_blocks) : 0; // its first number: 0 if taken out
  const auto history_size = static_cast<std::size_t>(law.history);
  const Point3 h = space_.model().grid.span_size();
  for_indices(num_blocks, 64, [&](std::size_t b) {
    LawInput in;
    in.length = std::min({h[0], h[1], h[2]});
    for (int k = 0; k < 9; ++k) in.F.c[k] = Lanes{} + (k % 4 == 0 ? 1.0 : 0.0);
    const std::int64_t* point = &points[lanes * b];
    for (std::size_t l = 0; l < lanes; ++l)
      if (point[l] >= 0)
        for (std::size_t k = 0; k < 9; ++k) in.F.c[k][l] = F[9 * static_cast<std::size_t>(point[l]) + k];
    in.F_old = in.F;
    std::vector<Lanes> history(std::max<std::size_t>(history_size, 1));
    if (history_size > 0)
      std::memcpy(history.data(), &saved.history[lanes * history_size * b], history_size * sizeof(Lanes));
    // Taken before the law is asked: without a rate the yield surface may lie lower, and the law would return to it.
    const Lanes plastic = law.plastic_strain >= 0 ? history[static_cast<std::size_t>(law.plastic_strain)] : Lanes{};
    TensorLanes P;
    LawOutput out;
    law.stress(law.law.get(), in, history.data(), P, out);
    for (std::size_t l = 0; l < lanes; ++l) {
      if (point[l] < 0) continue;
      const auto q = static_cast<std::size_t>(point[l]);
      Matrix3 Fq, Pq;
      for (int a = 0; a < 3; ++a)
        for (int c = 0; c < 3; ++c) {
          Fq(a, c) = in.F(a, c)[l];
          Pq(a, c) = P(a, c)[l];
        }
      samples.strain[q] = largest_log_strain(Fq);
      if (law.plastic_strain >= 0) samples.plastic_strain[q] = plastic[l];
      if (extra > 0 && saved.extra[lanes * extra * b + l] == 0) continue;
      const Matrix3 s = Pq * Fq.transpose() / out.J[l];
      const std::array<double, 6> components{s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
      std::copy(components.begin(), components.end(), &samples.stress[6 * q]);
    }
  });
  return samples;
}

std::vector<double> FieldSampler::carried(const std::vector<double>& at_points) const {
  const TrimmedModel& model = space_.model();
  const auto num_spans = static_cast<std::size_t>(space_.num_cells());
  std::vector<Eigen::MatrixX2d> parts(num_spans); // per function of the span: Σ w N s, Σ w N
  for_indices(num_spans, cells, [&](std::size_t a) {
    const auto span = static_cast<std::int64_t>(a);
    const auto parameters = cell_parameters(model, span);
    const auto weights = cell_weights(model, span);
    const auto nodes = space_.nodes(span);
    parts[a].setZero(static_cast<Eigen::Index>(nodes.size()), 2);
    if (weights.empty()) return;
    const auto first = static_cast<std::size_t>(weights.data() - model.points.weights.data());
    SpanShapes shapes;
    evaluate(space_, span, parameters, Shapes::Values, shapes);
    for (std::size_t q = 0; q < weights.size(); ++q) {
      const auto N = shapes.values.row(static_cast<Eigen::Index>(q)).head(static_cast<Eigen::Index>(nodes.size()));
      parts[a].col(0) += weights[q] * at_points[first + q] * N.transpose();
      parts[a].col(1) += weights[q] * N.transpose();
    }
  });
  Eigen::MatrixX2d sums = Eigen::MatrixX2d::Zero(space_.num_nodes(), 2);
  for (std::size_t a = 0; a < num_spans; ++a) {
    const auto nodes = space_.nodes(static_cast<std::int64_t>(a));
    for (std::size_t i = 0; i < nodes.size(); ++i) sums.row(nodes[i]) += parts[a].row(static_cast<Eigen::Index>(i));
  }
  // Functions without points (generalised rules skip spans) do not vote.
  const Eigen::VectorXd votes = (sums.col(1).array() > 0).cast<double>();
  const Eigen::VectorXd values =
      (sums.col(1).array() > 0).select(sums.col(0).array() / sums.col(1).array().max(1e-300), 0);
  const Eigen::VectorXd top = rows_ * values, bottom = rows_ * votes;
  std::vector<double> at_vertices(static_cast<std::size_t>(rows_.rows()));
  for (Eigen::Index v = 0; v < rows_.rows(); ++v)
    at_vertices[static_cast<std::size_t>(v)] = bottom[v] > 0 ? top[v] / bottom[v] : 0;
  return at_vertices;
}

BodyFields FieldSampler::sample(const ExplicitBody& body, bool points) const {
  const Eigen::VectorXd u = body.full_displacement();
  const InternalForces& forces = body.forces();
  return sample(u, forces.save(), forces.plan().point, points,
                forces.sees_mean_volume() ? mean_volume_scales(space_, u) : std::vector<double>{});
}

BodyFields FieldSampler::sample(const Eigen::VectorXd& u, const PointHistory& history,
                                std::span<const std::int64_t> point, bool points,
                                std::span<const double> scales) const {
  BodyFields fields;
  fields.name = mesh_.name;
  fields.coefficients.assign(u.data(), u.data() + u.size());
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> c(u.data(), u.size() / 3, 3);
  const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> at_vertices = rows_ * c;
  fields.displacement.assign(at_vertices.data(), at_vertices.data() + at_vertices.size());
  PointSamples samples = sample_points(u, history, point, scales);
  std::vector<double> mises(samples.strain.size());
  for (std::size_t q = 0; q < mises.size(); ++q) mises[q] = von_mises(&samples.stress[6 * q]);
  fields.von_mises = carried(mises);
  fields.strain = carried(samples.strain);
  if (!samples.plastic_strain.empty()) fields.plastic_strain = carried(samples.plastic_strain);
  if (points) {
    fields.point_stress = std::move(samples.stress);
    fields.point_plastic_strain = std::move(samples.plastic_strain);
  }
  return fields;
}

} // namespace iga::solve
