// The critical time step of explicit dynamics: 2 / ω_max.
#pragma once

#include "solver/analysis/prepared_system.hpp"
#include "solver/mechanics/element_bound.hpp"

namespace iga::solve {

/// omega in radians per time.
struct TimestepOutcome : SystemOutcome {
  double omega_max = 0;       ///< by Lanczos, to 1e-3, from below
  double omega_max_bound = 0; ///< 1.01 omega_max: safe
  double dt_crit = 0;         ///< 2 / omega_max
  double dt_safe = 0;         ///< 2 / omega_max_bound
  std::optional<ElementBound> element;
  double dt_element = 0; ///< 2 / element->omega; 0 where there is no such bound
  std::int64_t products = 0;
};

/// @param models  placed, one for each body of the run
/// @throws InputError for constraints by Lagrange multipliers, which explicit dynamics does not know
TimestepOutcome analyse_timestep(const RunSettings& run, std::span<const TrimmedModel> models);

} // namespace iga::solve
