// What the points of a model are asked to be, and how they came about.
#pragma once

#include "preprocessor/reduce/reduction_counts.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace iga::prep {

struct QuadratureOptions {
  std::string interior_rule = "gauss"; ///< gauss | ggq | ggq-reduced | ggq-reduced2
  std::string trimmed_rule = "nnls";   ///< nnls | minimal
  std::string surface_rule = "exact";  ///< exact | reduced
  std::array<int, 3> moment_degree{2, 2, 2};
  double tolerance = 1e-10; ///< on the relative moment residual of every span
  /// Of the minimal rule: at least as many points in a span as the rank of its own stiffness asks for (a span that the
  /// solid fills by less than a tenth may have fewer).
  bool rank_bound = false;
  std::function<void(std::int64_t done, std::int64_t total)> progress; ///< called from worker threads now and then
  /// Polled; true ends the fitting with Cancelled, and leaves the rules not yet reduced as they are.
  std::function<bool()> cancelled;
};

/// @throws InputError for rules and degrees that there are not
void check_options(const QuadratureOptions& options);

/// How the spans got their rules; for the report.
struct QuadratureCounts {
  std::int64_t interior_boxes = 0; ///< boxes of interior spans that share a rule; 0 where each span has its own
  std::int64_t box_spans = 0;      ///< axis-aligned boxes: Gauss on the box
  std::int64_t prism_spans = 0;    ///< prisms along an axis: 2-D fit × Gauss
  std::int64_t fitted_spans = 0;   ///< 3-D moment fitting
  std::int64_t refined_spans = 0;  ///< fitted spans that needed more than the first set of candidates
  std::int64_t kept_spans = 0;     ///< spans that keep their fitted rule because the reduction was interrupted
  ReductionCounts reduction;
  std::int64_t stabilised_spans = 0; ///< got a rule with more points, lest the part has a mechanism
};

} // namespace iga::prep
