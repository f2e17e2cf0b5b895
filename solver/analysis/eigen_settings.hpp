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
  bool prestress = false; ///< modes about the state that the run's loads bring the part into
  int block = 4;          ///< Lanczos vectors at a time
  /// Instead of `modes`: all elastic modes below this frequency (cycles per time), at least the first one.
  std::optional<double> modes_below = std::nullopt;
};

/// More modes below a frequency than this are refused: nobody reads them, and each takes a vector of all unknowns.
constexpr std::int64_t most_modes_below = 2000;

/// Number of unknowns below which the Sturm count is made unless it is declined.
constexpr std::int64_t sturm_default = 100'000;

} // namespace iga::solve
