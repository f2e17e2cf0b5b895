#include "solver/explicit/run/background_work.hpp"

#include "solver/base/parallel.hpp"

#include <tbb/global_control.h>
#include <utility>

namespace iga::solve {

BackgroundWork::~BackgroundWork() {
  std::unique_lock lock(mutex_);
  if (jobs_.size() > 1) jobs_.erase(jobs_.begin() + 1, jobs_.end());
  changed_.wait(lock, [this] { return jobs_.empty(); });
}

void BackgroundWork::add(std::function<void()> job) {
  if (tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) < 2) {
    const ParallelTime::Section section; // no serial work: with more threads it goes on beside the steps
    return job();
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.size() < 1 + most_waiting; });
  rethrow();
  jobs_.push_back(std::move(job));
  if (jobs_.size() == 1) arena_.enqueue([this] { work(); });
}

void BackgroundWork::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.empty(); });
  rethrow();
}

bool BackgroundWork::is_idle() {
  const std::scoped_lock lock(mutex_);
  return jobs_.empty();
}

void BackgroundWork::work() {
  std::unique_lock lock(mutex_);
  while (!jobs_.empty()) {
    const std::function<void()>& job = jobs_.front(); // stays where it is while others are added
    lock.unlock();
    std::exception_ptr error;
    try {
      job();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    jobs_.pop_front();
    if (error) {
      error_ = error;
      jobs_.clear();
    }
    changed_.notify_all();
  }
}

// @pre the lock is held
void BackgroundWork::rethrow() {
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

} // namespace iga::solve
