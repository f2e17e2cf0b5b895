// Linear buckling of a trimmed model under the loads of a run.
#pragma once

#include "solver/analysis/buckling_solver.hpp"
#include "solver/analysis/preload.hpp"
#include "solver/analysis/prepared_system.hpp"

namespace iga::solve {

/// Up to this strain of the loads themselves factors are looked for: beyond it linear elasticity says nothing, and
/// motions inside single spans begin to buckle.
constexpr double largest_buckling_strain = 0.25;

/// What `igasolve buckling` reports.
struct BucklingOutcome : SystemOutcome {
  Preload growing;                 ///< loads that the factor multiplies, at factor 1
  std::optional<Preload> constant; ///< loads that stay as they are
  BucklingModes positive;
  std::optional<BucklingModes> negative; ///< of the reversed loads, where asked for
  double limit = 0;                      ///< size of factors up to which they were looked for
  FactorCost cost;
  std::int64_t bodies = 0, constraints = 0;
};

/// @param models  placed, one for each body of the run
/// @throws InputError for runs without loads, parts that supports do not hold, and constant loads that make the part
/// buckle by themselves; else as its parts
BucklingOutcome analyse_buckling(const RunSettings& run, const BucklingSettings& settings,
                                 std::span<const TrimmedModel> models);
inline BucklingOutcome analyse_buckling(const RunSettings& run, const BucklingSettings& settings,
                                        const TrimmedModel& model) {
  return analyse_buckling(run, settings, {&model, 1});
}

/// The least positive factor; none within the limit of largest_buckling_strain.
/// @param K  stiffness without that of the preload
std::optional<double> first_factor(const StiffnessMatrix& K, const ConstraintMatrix* constraints,
                                   const Preload& preload, io::Progress* progress);

} // namespace iga::solve
