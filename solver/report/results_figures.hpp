// Does a results file belong to a model, and does it say the same by its coefficients and by its samples?
#pragma once

#include "format/model/model_figures.hpp"
#include "format/model/results.hpp"

#include <string>
#include <vector>

namespace iga::solve {

/// Rows of the table of `igasolve check model.h5 results.h5`: the model's name by its bytes; of a single body the
/// functions, and of a static analysis the quadrature points and their displacements, which must be Σ N c of the
/// coefficients.
/// @param sha256  of the model file
/// @pre check(model) found nothing
std::vector<CheckFigure> measure_results(const Results& results, const TrimmedModel& model, const std::string& sha256);

} // namespace iga::solve
