// Extension: the coefficients of light functions follow those of well-filled ones. Höllig, Reif, Wipper (2001),
// weighted extended B-splines; the linear variant keeps rigid motions and constant strains and few masters.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/space/light_treatment.hpp"

namespace iga::solve {

/// One light unknown as a combination of others; where no gap ends, unknowns are the entries of model.functions.
struct Slave {
  std::int64_t unknown = 0;
  std::vector<std::pair<std::int64_t, double>> masters; ///< ascending; empty: the coefficient is zero
};

struct LightFunctionPlan {
  std::vector<Slave> slaves;      ///< ascending unknown
  std::vector<double> fictitious; ///< (num_cells): SolutionSpace::fictitious_share; empty: nowhere
  std::vector<std::string> warnings;
};

/// Which functions are light and whom they follow. A good cell is one without light functions; each light function
/// follows the good cell nearest to its centre (in index space, the lowest number on ties) that links connect with the
/// cells of the function: never one across a gap. Where a connected part has no good cell the threshold falls by
/// factors of 10 there, and where that finds none, its cells are filled with a little fictitious material.
LightFunctionPlan plan_light_functions(const TrimmedModel& model, const LightTreatment& treatment);

} // namespace iga::solve
