// Work done in parallel whose results are taken one after the other: sums do not depend on the number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace iga::solve {

/// Calls use(i, compute(i)) for i = 0 … count - 1 in ascending order; compute runs in parallel, a group at a time, so
/// that few results are held at once.
template <class Compute, class Use> void in_order(std::size_t count, Compute&& compute, Use&& use) {
  constexpr std::size_t group = 64;
  using Result = decltype(compute(std::size_t{0}));
  std::vector<Result> results(std::min(group, count));
  for (std::size_t first = 0; first < count; first += group) {
    const std::size_t size = std::min(group, count - first);
    tbb::parallel_for(std::size_t{0}, size, [&](std::size_t k) { results[k] = compute(first + k); });
    for (std::size_t k = 0; k < size; ++k) use(first + k, results[k]);
  }
}

} // namespace iga::solve
