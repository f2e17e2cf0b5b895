// The embedded surface made fine enough to show smooth fields, and the fields on it.
#pragma once

#include "solver/output/sample_fields.hpp"

namespace iga::solve {

/// The model's surface, its long edges halved until none is longer than span / subdivide (measured along the grid's
/// axes in spans). Whether an edge is halved depends on that edge alone, so no crack opens between triangles. The
/// model's vertices come first, unchanged; every vertex belongs to a cell.
/// @throws InputError where subdivide < 1, or where the triangles would be too many, naming the number
OutputMesh subdivide_surface(const TrimmedModel& model, int subdivide);

/// The same with a bound on the edges' length instead.
OutputMesh refine_surface(const TrimmedModel& model, double longest);

/// @param unknowns  (num_unknowns × steps.size())
/// @param steps     what the steps stand for, ascending (results.hpp)
SurfaceResult sample_surface(const SolutionSpace& space, const ElasticMaterial& material, OutputMesh output,
                             const Eigen::Ref<const Eigen::MatrixXd>& unknowns, std::vector<double> steps,
                             Fields fields);

} // namespace iga::solve
