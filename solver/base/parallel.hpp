// Parallel loops whose results do not depend on the number of threads, and how much time a thread spends in them.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace iga::solve {

/// CPU time of the calling thread, and of all threads of the program; seconds. System calls of some tenths of a
/// microsecond.
double thread_cpu_seconds();
double process_cpu_seconds();

/// CPU time that threads spend in the parallel loops that they begin; the rest of a thread's time is serial work. On
/// one thread both are exact whatever else the machine does. Nothing is measured until it is switched on.
class ParallelTime {
 public:
  static void measure(bool on) { on_ = on; }
  static bool is_measured() { return on_; }
  /// Of the calling thread so far, seconds.
  static double seconds() { return seconds_; }

  /// Lives as long as the loop does; loops within loops belong to the outer one.
  class Section {
   public:
    Section() : is_outer_(on_ && depth_ == 0) {
      if (is_outer_) {
        ++depth_;
        begin_ = thread_cpu_seconds();
      }
    }
    ~Section() {
      if (is_outer_) {
        --depth_;
        seconds_ += thread_cpu_seconds() - begin_;
      }
    }
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;

   private:
    bool is_outer_;
    double begin_ = 0;
  };

 private:
  static inline std::atomic<bool> on_{false};
  static inline thread_local int depth_ = 0;
  static inline thread_local double seconds_ = 0;
};

constexpr std::size_t num_chunks(std::size_t count, std::size_t size) {
  return (count + size - 1) / size;
}

/// visit(chunk, first, last) for the pieces [first, last) of 0 … count of `size` each, in parallel. The pieces are the
/// same for any number of threads: partial sums kept by chunk and added in their order have the same bits.
template <class Visit> void for_chunks(std::size_t count, std::size_t size, Visit&& visit) {
  const std::size_t chunks = num_chunks(count, size);
  const auto one = [&](std::size_t c) { visit(c, c * size, std::min(count, (c + 1) * size)); };
  if (chunks <= 1) { // not worth another thread
    if (chunks == 1) one(0);
    return;
  }
  const ParallelTime::Section section;
  tbb::parallel_for(std::size_t{0}, chunks, one);
}

/// visit(i) for 0 … count - 1 in parallel, `grain` of them at a time.
template <class Visit> void for_indices(std::size_t count, std::size_t grain, Visit&& visit) {
  for_chunks(count, grain, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) visit(i);
  });
}

} // namespace iga::solve
