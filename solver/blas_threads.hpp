// OpenBLAS has threads of its own; they follow the number the run was given.
#pragma once

namespace iga::solve {

/// Number of threads of the run: what TBB is limited to.
int run_threads();

/// Lets OpenBLAS use as many threads as the run. To be called before work on factors.
void follow_run_threads();

} // namespace iga::solve
