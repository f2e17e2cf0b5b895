// Displacement, strain and stress at given points: on the surface, at quadrature points, at probes.
#pragma once

#include "format/model/results.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/space/solution_space.hpp"

namespace iga::solve {

/// Where fields are wanted.
struct SamplePoints {
  std::vector<std::int64_t> cell; ///< (n); that owns each
  std::vector<double> parameters; ///< (n × 3), row-major, in the closed span of the cell
};

enum class Fields {
  Displacement,
  VonMises, ///< displacement and von Mises stress
  All,      ///< strain and stress too
};

/// Strains are those of the displacement; stresses C (ε - ε₀) with the material's initial strain, the same in all
/// steps. This is the one place where stresses of a solution are made.
/// @param unknowns  (num_unknowns × steps)
/// Parallel; the same bits for any number of threads.
FieldSamples sample_fields(const SolutionSpace& space, const ElasticMaterial& material, const SamplePoints& points,
                           const Eigen::Ref<const Eigen::MatrixXd>& unknowns, Fields fields);

} // namespace iga::solve
