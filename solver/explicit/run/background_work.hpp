// Work beside the steps of a run, such as writing files.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <tbb/task_arena.h>

namespace iga::solve {

/// Jobs one after the other, in the order in which they come, on a thread that the run has anyway; on one thread each
/// is done where it is added. What a job throws is thrown by the next add or wait, and the jobs after it are dropped.
class BackgroundWork {
 public:
  BackgroundWork() = default;
  /// Waits for the job that is being done; others are dropped.
  ~BackgroundWork();
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  /// Waits where two are waiting already: what they hold takes memory.
  void add(std::function<void()> job);
  void wait();
  bool is_idle();

 private:
  void work();
  void rethrow();

  static constexpr std::size_t most_waiting = 2;
  tbb::task_arena arena_{1, 0};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_; ///< the first one is being done
  std::exception_ptr error_;
};

} // namespace iga::solve
