#include "solver/recover.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace iga::solve {

namespace {

FieldSamples make_samples(std::size_t n) {
  FieldSamples samples;
  samples.displacement.resize(3 * n);
  samples.strain.resize(6 * n);
  samples.stress.resize(6 * n);
  samples.von_mises.resize(n);
  return samples;
}

/// Displacement and its gradient at the points of one span, then all fields.
class SpanRecovery {
 public:
  SpanRecovery(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u)
      : space_(space), material_(material), u_(u) {}

  void at(std::int64_t a, std::span<const double> parameters) {
    evaluate(space_, a, parameters, Shapes::Both, shapes_);
    const auto nodes = space_.nodes(a);
    const auto count = static_cast<Eigen::Index>(nodes.size()), n = shapes_.values.rows();
    coefficients_.resize(count, 3);
    for (Eigen::Index r = 0; r < count; ++r)
      coefficients_.row(r) = u_.segment<3>(3 * nodes[static_cast<std::size_t>(r)]).transpose();
    displacement_.noalias() = shapes_.values * coefficients_;
    gradient_.resize(n, 9);
    along_.resize(n, count);
    for (Eigen::Index d = 0; d < 3; ++d) {
      for (Eigen::Index r = 0; r < count; ++r) along_.col(r) = shapes_.gradients.col(3 * r + d);
      const Eigen::MatrixXd slope = along_ * coefficients_;
      for (Eigen::Index c = 0; c < 3; ++c) gradient_.col(3 * c + d) = slope.col(c);
    }
  }
  /// Point q of the span becomes point `to` of the samples.
  void write(Eigen::Index q, std::size_t to, FieldSamples& samples) const {
    const auto g = [&](Eigen::Index c, Eigen::Index d) { return gradient_(q, 3 * c + d); };
    Voigt strain;
    strain << g(0, 0), g(1, 1), g(2, 2), g(0, 1) + g(1, 0), g(1, 2) + g(2, 1), g(2, 0) + g(0, 2);
    const Voigt stress = material_.C * strain;
    for (std::size_t d = 0; d < 3; ++d)
      samples.displacement[3 * to + d] = displacement_(q, static_cast<Eigen::Index>(d));
    std::copy_n(strain.data(), 6, samples.strain.data() + 6 * to);
    std::copy_n(stress.data(), 6, samples.stress.data() + 6 * to);
    samples.von_mises[to] = von_mises(stress);
  }

 private:
  const SolutionSpace& space_;
  const ElasticMaterial& material_;
  const Eigen::VectorXd& u_;
  SpanShapes shapes_;
  Eigen::MatrixXd coefficients_, along_;
  Eigen::MatrixXd displacement_; ///< (n × 3)
  Eigen::MatrixXd gradient_;     ///< (n × 9); column 3 c + d is ∂u_c/∂x_d
};

} // namespace

FieldSamples recover_fields(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                            std::span<const std::int64_t> offsets, std::span<const double> parameters) {
  FieldSamples fields = make_samples(parameters.size() / 3);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, space.num_spans(), 16), [&](const auto& range) {
    SpanRecovery recovery(space, material, u);
    for (std::int64_t a = range.begin(); a != range.end(); ++a) {
      const auto first = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a)]);
      const auto count = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a) + 1]) - first;
      if (count == 0) continue;
      recovery.at(a, parameters.subspan(3 * first, 3 * count));
      for (std::size_t q = 0; q < count; ++q) recovery.write(static_cast<Eigen::Index>(q), first + q, fields);
    }
  });
  return fields;
}

double strain_energy(const TrimmedModel& model, const FieldSamples& fields) {
  double energy = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    double density = 0;
    for (std::size_t k = 0; k < 6; ++k) density += fields.stress[6 * q + k] * fields.strain[6 * q + k];
    energy += 0.5 * model.points.weights[q] * density;
  }
  return energy;
}

std::vector<LocatedPoint> locate_probes(const TrimmedModel& model, std::span<const Probe> probes) {
  std::vector<LocatedPoint> located;
  for (const Probe& probe : probes)
    located.push_back(locate(model, probe.position, fmt::format("probe '{}'", probe.name)));
  return located;
}

ProbeResult recover_probes(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                           std::span<const Probe> probes, std::span<const LocatedPoint> located) {
  SpanRecovery recovery(space, material, u);
  ProbeResult result;
  result.fields = make_samples(probes.size());
  for (std::size_t k = 0; k < probes.size(); ++k) {
    result.names.push_back(probes[k].name);
    result.positions.insert(result.positions.end(), located[k].position.begin(), located[k].position.end());
    recovery.at(located[k].span, located[k].parameter);
    recovery.write(0, k, result.fields);
  }
  return result;
}

} // namespace iga::solve
