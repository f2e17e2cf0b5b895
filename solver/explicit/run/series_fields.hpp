// Fields of a moving body for the eye: displacement of its surface, stress and strain carried there from the quadrature
// points.
#pragma once

#include "format/model/results.hpp"
#include "solver/explicit/motion/explicit_body.hpp"

namespace iga::solve {

/// Stress belongs to the quadrature points, whose history it depends on. s_i = Σ w N_i s / Σ w N_i carries a number to
/// the functions (lumped projection: bounded by the points' values, so that no spike appears that no point has), their
/// sum to the vertices.
class FieldSampler {
 public:
  /// @param body, its model must outlive the sampler
  /// @param subdivide  of the surface: edges at most span / subdivide
  FieldSampler(const ExplicitBody& body, const Law& law, int subdivide);

  const BodyMesh& mesh() const { return mesh_; }
  /// At the body's present state. @param points  with stresses and plastic strains at the quadrature points
  BodyFields sample(bool points) const;

 private:
  struct PointSamples {
    std::vector<double> stress;         ///< (n_points × 6) σ by the law at the points' present history, no rates
    std::vector<double> strain;         ///< (n_points) the largest principal ln U by size
    std::vector<double> plastic_strain; ///< (n_points), empty for laws without one
  };
  PointSamples sample_points() const;
  std::vector<double> carried(const std::vector<double>& at_points) const;

  const ExplicitBody* body_;
  Law law_;
  SolutionSpace space_; ///< of all functions
  BodyMesh mesh_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows_; ///< (n_v × n_f) N_i at the vertices
};

} // namespace iga::solve
