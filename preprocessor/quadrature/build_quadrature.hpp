// Quadrature points of all active spans: the rule of interior spans, moment fitting on trimmed ones.
#pragma once

#include "format/model/trimmed_model.hpp"
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

/// Functions whose support holds material, ascending, and their mass fractions (numerics: ∫_Ω N / ∫ N).
struct FunctionMass {
  std::vector<std::int64_t> functions;
  std::vector<double> mass_fraction;
};
FunctionMass function_mass(const SplineGrid& grid, const Trimming& trimming, const IntegrationPoints& points);

} // namespace iga::prep
