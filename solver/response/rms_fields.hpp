// Root mean squares over the surface.
#pragma once

#include "solver/output/sample_fields.hpp"

namespace iga::solve {

/// Root mean squares (1 sigma) of displacement, strain and stress, component by component, and of the von Mises stress,
/// of u = Σ_c z_c column_c with independent z of unit variance.
/// @param columns  (num_unknowns × n)
FieldSamples rms_fields(const SolutionSpace& space, const ElasticMaterial& material, const SamplePoints& points,
                        const Eigen::Ref<const Eigen::MatrixXd>& columns);

} // namespace iga::solve
