// Extension: the coefficients of light functions follow those of well-filled ones. Höllig, Reif, Wipper (2001),
// weighted extended B-splines; the linear variant keeps rigid motions and constant strains and few masters.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/space/light_treatment.hpp"

namespace iga::solve {

/// One light function as a combination of others; entries are positions in model.active_functions.
struct Slave {
  std::int64_t function = 0;
  std::vector<std::pair<std::int64_t, double>> masters; ///< ascending; empty: the coefficient is zero
};

struct LightFunctionPlan {
  std::vector<Slave> slaves;      ///< ascending function
  std::vector<double> fictitious; ///< (num_active): SolutionSpace::fictitious_share; empty: nowhere
  std::vector<std::string> warnings;
};

/// Position in model.active_functions of the p_u + 1 functions (·, b, c) of each active span, b fastest: they lie one
/// after the other. (num_active × (p_v + 1)(p_w + 1)) @throws FormatError where a span's function is not active
std::vector<std::int64_t> function_rows(const TrimmedModel& model);

/// Which functions are light and whom they follow. A good span is one without light functions; each light function
/// follows the good span nearest to its centre (in index space, the lowest number on ties) that face-adjacent active
/// spans connect with its support. Where a connected part has no good span the threshold falls by factors of 10 there,
/// and where that finds none, its spans are filled with a little fictitious material.
LightFunctionPlan plan_light_functions(const TrimmedModel& model, const std::vector<std::int64_t>& rows,
                                       const LightTreatment& treatment);

} // namespace iga::solve
