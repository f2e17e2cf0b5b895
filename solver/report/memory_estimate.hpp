// What an analysis of a model will need, before it is run.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::solve {

/// Peak memory in bytes, without supports; from a symbolic factorisation, no number is touched.
struct MemoryEstimate {
  double eigen = 0; ///< ten modes, consistent mass, default treatment of light functions
  double statics = 0;
  double factor_nonzeros = 0;
};

MemoryEstimate estimate_memory(const TrimmedModel& model);

} // namespace iga::solve
