// How the reduction of points went; summed over spans for the report.
#pragma once

#include <cstdint>

namespace iga::prep {

/// Where points could be taken out of trimmed spans, by what moved the others.
struct ReductionCounts {
  std::int64_t newton = 0;    ///< points removed after Gauss–Newton steps
  std::int64_t bounded = 0;   ///< points removed after a bounded descent where Gauss–Newton stalled
  std::int64_t stalls = 0;    ///< rules on which the bounded descent was tried
  std::int64_t unchanged = 0; ///< rules that could not be reduced at all
  ReductionCounts& operator+=(const ReductionCounts& other) {
    newton += other.newton;
    bounded += other.bounded;
    stalls += other.stalls;
    unchanged += other.unchanged;
    return *this;
  }
};

} // namespace iga::prep
