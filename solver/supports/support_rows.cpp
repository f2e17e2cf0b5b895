#include "solver/supports/support_rows.hpp"

#include "format/model/vec3.hpp"

#include <Eigen/LU>

namespace iga::solve {

namespace {

using Row3 = Eigen::Matrix<double, 1, 3>;

// s · B for one node: B is the strain of the node's three components (xx yy zz xy yz zx, engineering shears) with
// gradient g.
Row3 times_strain(const Eigen::Matrix<double, 1, 6>& s, double gx, double gy, double gz) {
  return {s[0] * gx + s[3] * gy + s[5] * gz, s[1] * gy + s[3] * gx + s[4] * gz, s[2] * gz + s[4] * gy + s[5] * gx};
}

} // namespace

FixedDirections fixed_directions(const PreparedSupport& prepared, const Point3& normal, const Point3& position) {
  const Support& support = prepared.support;
  FixedDirections fixed;
  if (support.radial) {
    fixed.count = support.axial ? 2 : 1;
    fixed.direction = {prepared.cylinder.radial(position), prepared.cylinder.axis};
    fixed.prescribed[0] = support.value[0];
    return fixed;
  }
  if (support.along_normal) {
    fixed.count = 1;
    fixed.direction[0] = normal;
    fixed.prescribed[0] = support.value[0];
    return fixed;
  }
  for (std::size_t d = 0; d < 3; ++d) {
    if (!support.fixed[d]) continue;
    const auto next = static_cast<std::size_t>(fixed.count++);
    for (std::size_t r = 0; r < 3; ++r) fixed.direction[next][r] = support.frame[r][d];
    fixed.prescribed[next] = support.value[d] + dot(support.gradient[d], position);
  }
  return fixed;
}

Eigen::Matrix<double, 3, 6> traction_of_stress(const Point3& n) {
  Eigen::Matrix<double, 3, 6> T;
  T << n[0], 0, 0, n[1], 0, n[2], //
      0, n[1], 0, n[0], n[2], 0,  //
      0, 0, n[2], 0, n[1], n[0];
  return T;
}

double effective_modulus(const ElasticMaterial& material) {
  const VoigtMatrix compliance = material.C.inverse();
  return 3 / (compliance(0, 0) + compliance(1, 1) + compliance(2, 2));
}

SupportRows make_rows(const SolutionSpace& space, const ElasticMaterial& material, const PreparedSupport& prepared,
                      const PointBatch& batch, RowParts parts, SpanShapes& shapes) {
  const auto nodes = static_cast<Eigen::Index>(space.nodes(batch.cell).size());
  const bool trace = parts != RowParts::Traction, traction = parts != RowParts::Trace;
  evaluate(space, batch.cell, batch.parameters,
           trace && traction ? Shapes::Both : (trace ? Shapes::Values : Shapes::Gradients), shapes);
  SupportRows rows;
  std::vector<double> weights, prescribed;
  for (std::size_t q = 0; q < batch.size(); ++q) {
    const FixedDirections fixed = fixed_directions(prepared, batch.normals[q], batch.positions[q]);
    for (std::size_t d = 0; d < static_cast<std::size_t>(fixed.count); ++d) {
      weights.push_back(batch.weights[q]);
      prescribed.push_back(fixed.prescribed[d]);
      rows.point.push_back(static_cast<std::int32_t>(q));
      rows.direction.push_back(fixed.direction[d]);
    }
  }
  const auto m = static_cast<Eigen::Index>(weights.size());
  rows.weight = Eigen::Map<const Eigen::VectorXd>(weights.data(), m);
  rows.prescribed = Eigen::Map<const Eigen::VectorXd>(prescribed.data(), m);
  if (trace) rows.trace.resize(m, 3 * nodes);
  if (traction) rows.traction.resize(m, 3 * nodes);
  Strains initial;
  if (traction && material.initial_strain) {
    initial = material.initial_strain->at(batch.cell, batch.parameters);
    rows.initial.resize(m);
  }
  for (Eigen::Index k = 0; k < m; ++k) {
    const auto q = static_cast<Eigen::Index>(rows.point[static_cast<std::size_t>(k)]);
    const Point3& e = rows.direction[static_cast<std::size_t>(k)];
    const Row3 direction(e[0], e[1], e[2]);
    if (trace)
      for (Eigen::Index i = 0; i < nodes; ++i) rows.trace.block<1, 3>(k, 3 * i) = shapes.values(q, i) * direction;
    if (!traction) continue;
    const Eigen::Matrix<double, 1, 6> s =
        direction * traction_of_stress(batch.normals[static_cast<std::size_t>(q)]) * material.C;
    if (initial.rows() > 0) rows.initial[k] = s.dot(initial.row(q));
    for (Eigen::Index i = 0; i < nodes; ++i)
      rows.traction.block<1, 3>(k, 3 * i) =
          times_strain(s, shapes.gradients(q, 3 * i), shapes.gradients(q, 3 * i + 1), shapes.gradients(q, 3 * i + 2));
  }
  return rows;
}

} // namespace iga::solve
