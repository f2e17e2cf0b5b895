// Quadrature points of all active spans: the rule of interior spans, moment fitting on trimmed ones.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/trim.hpp"

#include <functional>

namespace iga::prep {

struct QuadratureOptions {
  std::string interior_rule = "gauss"; ///< gauss | ggq | ggq-reduced | ggq-reduced2
  std::string trimmed_rule = "nnls";
  std::array<int, 3> moment_degree{2, 2, 2};
  double tolerance = 1e-10; ///< on the relative moment residual of every span
  std::function<void(std::int64_t done, std::int64_t total)> progress; ///< called from worker threads now and then
  std::function<bool()> cancelled;                                     ///< polled; true stops the work with Cancelled
};

/// How the spans got their rules; for the report.
struct QuadratureCounts {
  std::int64_t interior_boxes = 0; ///< boxes of interior spans that share a rule; 0 where each span has its own
  std::int64_t box_spans = 0;      ///< axis-aligned boxes: Gauss on the box
  std::int64_t prism_spans = 0;    ///< prisms along an axis: 2-D fit × Gauss
  std::int64_t fitted_spans = 0;   ///< 3-D moment fitting
  std::int64_t refined_spans = 0;  ///< fitted spans that needed more than the first set of candidates
};

struct QuadratureResult {
  IntegrationPoints points;
  double max_residual = 0;
  QuadratureCounts counts;
};

struct Cancelled {};

/// @throws NumericalError naming the spans that did not reach the tolerance
QuadratureResult build_quadrature(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options);

/// Functions whose support holds material, ascending, and their mass fractions (numerics: ∫_Ω N / ∫ N).
struct FunctionMass {
  std::vector<std::int64_t> functions;
  std::vector<double> mass_fraction;
};
FunctionMass function_mass(const SplineGrid& grid, const Trimming& trimming, const IntegrationPoints& points);

} // namespace iga::prep
