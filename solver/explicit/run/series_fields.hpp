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
  /// @param model      must outlive the sampler
  /// @param subdivide  of the surface: edges at most span / subdivide
  FieldSampler(const TrimmedModel& model, const std::string& name, const Law& law, int subdivide);

  const BodyMesh& mesh() const { return mesh_; }
  /// @param u        (3 n_f) coefficients of the model's functions
  /// @param history  of the points in blocks of eight
  /// @param point    (8 blocks): number of each in the model, -1 for none
  /// @param points   with stresses and plastic strains at the quadrature points
  /// @param scales   (n_points) the law sees these times F; empty: it sees F
  BodyFields sample(const Eigen::VectorXd& u, const PointHistory& history, std::span<const std::int64_t> point,
                    bool points, std::span<const double> scales = {}) const;
  /// The same of an explicit body's present state.
  BodyFields sample(const ExplicitBody& body, bool points) const;

 private:
  struct PointSamples {
    std::vector<double> stress;         ///< (n_points × 6) σ by the law at the points' present history, no rates
    std::vector<double> strain;         ///< (n_points) the largest principal ln U by size
    std::vector<double> plastic_strain; ///< (n_points), empty for laws without one
  };
  PointSamples sample_points(const Eigen::VectorXd& u, const PointHistory& saved, std::span<const std::int64_t> points,
                             std::span<const double> scales) const;
  std::vector<double> carried(const std::vector<double>& at_points) const;

  Law law_;
  SolutionSpace space_; ///< of all functions
  BodyMesh mesh_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows_; ///< (n_v × n_f) N_i at the vertices
};

} // namespace iga::solve
