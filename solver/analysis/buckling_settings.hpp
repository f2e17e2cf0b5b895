// What is asked of a buckling analysis beyond the run's common settings.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace iga::solve {

struct BucklingSettings {
  int factors = 5;                   ///< of lowest size, of each sign that is asked for
  bool negative = false;             ///< those of the reversed loads too
  std::vector<std::string> constant; ///< names of loads that do not grow with the factor
  std::optional<bool> sturm; ///< prove by a Sturm count that none was missed; default: below sturm_default unknowns
};

} // namespace iga::solve
