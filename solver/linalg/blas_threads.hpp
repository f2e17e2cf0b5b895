// OpenBLAS has threads of its own; they follow the number the run was given, and the memory that is left.
//
// Each of its threads holds a buffer of 128 MiB. Where that cannot be had (ulimit -v, a system that promises no more
// memory than it has), OpenBLAS tries again for ever: a thread that spins, and a program that waits for it when it
// ends.
#pragma once

namespace iga::solve {

/// Number of threads of the run: what TBB is limited to.
int run_threads();

/// Lets OpenBLAS use as many threads as the run, or fewer where the memory holds no buffers for them. To be called
/// before work on factors. @throws std::bad_alloc without memory for the buffer of the calling thread
void follow_run_threads();

/// To be called first of all. OpenBLAS starts its threads while the program is loaded; where there is no memory for
/// their buffers, the program starts itself again with one thread for OpenBLAS, which needs no buffer until it works,
/// and one for OpenMP (OPENBLAS_NUM_THREADS=1, OMP_THREAD_LIMIT=1).
/// @param arguments  argv of main, ended by a null pointer
void keep_blas_within_memory(char** arguments);

} // namespace iga::solve
