// Small systems for the tests of linear solvers and eigenvalues: a box in a grid, its matrices, dense copies of them.
#pragma once

#include "solver/assemble.hpp"
#include "solver/eigen_analysis.hpp"
#include "solver/rigid_modes.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>

namespace iga::test {

/// A cube or rod with `spans` spans of equal size inside a margin of `degree` spans; `cut` is the depth (in spans) to
/// which the outermost spans are filled on the upper sides.
inline BoxCase box_in_grid(const Point3& size, const Index3& spans, int degree, double cut = 1) {
  BoxCase box;
  box.degree = {degree, degree, degree};
  for (std::size_t d = 0; d < 3; ++d) {
    const double h = size[d] / (static_cast<double>(spans[d]) - 1 + cut);
    box.spans[d] = spans[d] + 2 * degree;
    box.A[d] = -degree * h;
    box.B[d] = box.A[d] + static_cast<double>(box.spans[d]) * h;
    box.lower[d] = 0;
    box.upper[d] = size[d];
  }
  return box;
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
    p.motions = solve::rigid_motions(space, solve::separate_bodies(K.pattern()));
    p.lambda_scale = solve::lambda_scale(space, material);
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
