#include "solver/blas_threads.hpp"

#include <cblas.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>

namespace iga::solve {

int run_threads() {
  const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max(1, std::min(static_cast<int>(limit), tbb::info::default_concurrency()));
}

void follow_run_threads() {
  const int threads = run_threads();
  if (openblas_get_num_threads() != threads) openblas_set_num_threads(threads);
}

} // namespace iga::solve
