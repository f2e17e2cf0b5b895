// Quadrature points of all active spans: the rule of interior spans, moment fitting on trimmed ones.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/connectivity/cells.hpp"
#include "preprocessor/quadrature/trimmed_rules.hpp"

namespace iga::prep {

struct QuadratureResult {
  IntegrationPoints points;
  double max_residual = 0;
  QuadratureCounts counts;
};

/// Points of all active spans from the rules of the trimmed ones, which are released on the way.
QuadratureResult place_points(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options,
                              TrimmedRules&& rules);

/// Fits, reduces where the options say so, and places.
/// @throws NumericalError naming the spans that did not reach the tolerance
QuadratureResult build_quadrature(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options);

/// ∫ N over its cells / ∫ N over the whole grid for each function of the table (numerics: mass fractions).
std::vector<double> mass_fractions(const SplineGrid& grid, const Trimming& trimming, const CellTable& cells,
                                   const IntegrationPoints& points);

/// Moves states, cells, functions, unknowns and links into a model. The functions' mass fractions are the caller's, and
/// where they are there already, those of the unknowns follow from them.
void place_cells(Trimming&& trimming, CellTable&& cells, TrimmedModel& model);

} // namespace iga::prep
