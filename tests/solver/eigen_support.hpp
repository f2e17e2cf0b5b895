// Small systems for the tests of linear solvers and eigenvalues: a box in a grid, its matrices, dense copies of them.
#pragma once

#include "solver/analysis/eigen_analysis.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>

namespace iga::test {

/// A box of about `size` with `spans` spans of equal size inside a margin of `degree` spans; `cut` is the depth (in
/// spans) to which the last spans on the upper sides are filled. Faces on knots lie there to the last bit.
inline BoxCase box_in_grid(const Point3& size, const Index3& spans, const std::array<int, 3>& degree,
                           const Point3& cut) {
  BoxCase box;
  box.degree = degree;
  for (std::size_t d = 0; d < 3; ++d) {
    const double h = size[d] / (static_cast<double>(spans[d]) - 1 + cut[d]);
    box.spans[d] = spans[d] + 2 * degree[d];
    box.A[d] = -degree[d] * h;
    box.B[d] = box.A[d] + static_cast<double>(box.spans[d]) * h;
  }
  const SplineGrid grid(box.A, box.B, box.spans, box.degree);
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = grid.knots(static_cast<int>(d));
    const std::int64_t last = degree[d] + spans[d] - 1;
    box.lower[d] = knots.lower(degree[d]);
    box.upper[d] =
        cut[d] == 1 ? knots.upper(last) : knots.lower(last) + cut[d] * (knots.upper(last) - knots.lower(last));
  }
  return box;
}
inline BoxCase box_in_grid(const Point3& size, const Index3& spans, int degree, double cut = 1) {
  return box_in_grid(size, spans, {degree, degree, degree}, {cut, cut, cut});
}

/// Two equal boxes of two spans each way, so far apart along x that they share no function: a long box whose spans in
/// between are taken out of the list of active ones. Only what a solution space reads is kept in order.
inline TrimmedModel make_two_boxes() {
  TrimmedModel long_box = make_box_model(box_in_grid({8, 1, 1}, {16, 2, 2}, 2)), model = long_box;
  const auto keep = [&](const Index3& span) { return span[0] < 4 || span[0] >= 16; };
  model.cells.span.clear();
  model.cells.state.clear();
  model.cells.volume_fraction.clear();
  model.points = {};
  model.points.offsets = {0};
  std::vector<bool> used(static_cast<std::size_t>(long_box.grid.num_functions()), false);
  for (std::size_t a = 0; a < long_box.cells.span.size(); ++a) {
    const Index3 span = long_box.grid.span_index(long_box.cells.span[a]);
    if (!keep(span)) {
      model.state[static_cast<std::size_t>(long_box.cells.span[a])] = 0;
      continue;
    }
    model.cells.span.push_back(long_box.cells.span[a]);
    model.cells.state.push_back(long_box.cells.state[a]);
    model.cells.volume_fraction.push_back(long_box.cells.volume_fraction[a]);
    for (auto q = long_box.points.offsets[a]; q < long_box.points.offsets[a + 1]; ++q) {
      const double* u = &long_box.points.parameters[3 * static_cast<std::size_t>(q)];
      model.points.parameters.insert(model.points.parameters.end(), u, u + 3);
      model.points.weights.push_back(long_box.points.weights[static_cast<std::size_t>(q)]);
    }
    model.points.offsets.push_back(static_cast<std::int64_t>(model.points.weights.size()));
    for (std::int64_t k = 0; k < 3; ++k)
      for (std::int64_t j = 0; j < 3; ++j)
        for (std::int64_t i = 0; i < 3; ++i)
          used[static_cast<std::size_t>(long_box.grid.function_number({span[0] + i, span[1] + j, span[2] + k}))] = true;
  }
  model.points.residual.assign(model.cells.span.size(), 0);
  model.functions.number.clear();
  model.functions.mass_fraction.clear();
  for (std::size_t f = 0; f < used.size(); ++f)
    if (used[f]) {
      model.functions.number.push_back(static_cast<std::int64_t>(f));
      model.functions.mass_fraction.push_back(1);
    }
  make_cells(model);
  return model;
}

struct System {
  System(TrimmedModel made, const solve::ElasticMaterial& made_of, solve::MassType type = solve::MassType::Consistent,
         const solve::LightTreatment& treatment = {})
      : model(std::move(made)), material(made_of), space(model, treatment),
        connectivity(std::make_shared<const solve::Connectivity>(space)),
        K(solve::assemble_stiffness(space, connectivity, material)),
        M(solve::make_mass(type, space, connectivity, material.density)) {}

  solve::EigenProblem problem() const {
    solve::EigenProblem p;
    p.stiffness = &K;
    p.mass = &M;
    const solve::BodySystem system(space, material);
    p.motions = solve::rigid_motions(system, solve::separate_bodies(K.pattern()));
    p.lambda_scale = solve::lambda_scale(system);
    return p;
  }

  TrimmedModel model;
  solve::ElasticMaterial material;
  solve::SolutionSpace space;
  std::shared_ptr<const solve::Connectivity> connectivity;
  solve::StiffnessMatrix K;
  solve::MassOperator M;
};

template <class Operator> Eigen::MatrixXd dense(const Operator& A, std::int64_t n) {
  Eigen::MatrixXd D(n, n);
  for (Eigen::Index i = 0; i < n; ++i) D.col(i) = A * Eigen::VectorXd(Eigen::VectorXd::Unit(n, i));
  return D;
}

} // namespace iga::test
