#include "solver/linalg/blas_threads.hpp"

#include <cblas.h>
#include <sys/mman.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string_view>

namespace iga::solve {

namespace {

constexpr std::size_t buffer_of_a_thread = std::size_t{128} << 20; // bytes; the largest of its builds for x86

// Asked as OpenBLAS asks for its buffers.
bool can_map(std::size_t bytes) {
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  munmap(memory, bytes);
  return true;
}

// OpenBLAS takes the buffer in the first call that needs one, and keeps it.
bool take_buffer() {
  if (!can_map(buffer_of_a_thread)) throw std::bad_alloc();
  const double one = 1;
  double x = 1;
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, 1, 1, 1, &one, 1, &x, 1);
  return true;
}

} // namespace

int run_threads() {
  const auto limit = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max(1, std::min(static_cast<int>(limit), tbb::info::default_concurrency()));
}

void follow_run_threads() {
  [[maybe_unused]] static const bool taken = take_buffer();
  const int threads = run_threads(), now = openblas_get_num_threads();
  if (threads < now || (threads > now && can_map(static_cast<std::size_t>(threads - now) * buffer_of_a_thread)))
    openblas_set_num_threads(threads);
}

void keep_blas_within_memory(char** arguments) {
  const char* const variable = "OPENBLAS_NUM_THREADS";
  const char* const set = std::getenv(variable);
  const int threads = openblas_get_num_threads();
  if (threads <= 1 || (set && std::string_view(set) == "1") ||
      can_map(static_cast<std::size_t>(threads) * buffer_of_a_thread))
    return;
  setenv(variable, "1", 1);
  setenv("OMP_THREAD_LIMIT", "1", 1); // the threads of CHOLMOD: OpenMP ends the program where it cannot start one
  execv("/proc/self/exe", arguments); // goes on here only where that is not possible
}

} // namespace iga::solve
