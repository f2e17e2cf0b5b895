// What is asked of an eigenvalue analysis beyond the run's common settings.
#pragma once

#include <cstdint>
#include <optional>

namespace iga::solve {

struct EigenSettings {
  int modes = 10;            ///< elastic modes, beside the rigid ones
  bool largest = false;      ///< the largest eigenfrequency instead of modes
  std::optional<bool> sturm; ///< prove by a Sturm count that none was missed; default: below sturm_default unknowns
  /// Estimate the errors of elastic modes from what they leave of the equations; default: where it can be done.
  std::optional<bool> errors = std::nullopt;
  int block = 4; ///< Lanczos vectors at a time
};

/// Number of unknowns below which the Sturm count is made unless it is declined.
constexpr std::int64_t sturm_default = 100'000;

} // namespace iga::solve
