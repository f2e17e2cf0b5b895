#include "solver/base/interruptible.hpp"

#include "format/io/interrupt.hpp"

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace iga::solve {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds poll_interval{50};
constexpr std::chrono::seconds patience{1};

std::atomic<int> outputs_being_written{0};

struct Outcome {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  int result = 0;
  std::exception_ptr error;
};

void run(const std::function<int()>& work, Outcome& outcome) {
  int result = 0;
  std::exception_ptr error;
  try {
    result = work();
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard lock(outcome.mutex);
  outcome.result = result;
  outcome.error = error;
  outcome.done = true;
  outcome.ended.notify_all();
}

// Not std::exit: it would run destructors of what the other threads are using.
[[noreturn]] void leave(int signal) {
  fmt::print(stderr, "\nigasolve: interrupted; no file was changed\n");
  std::fflush(stderr);
  _exit(128 + signal);
}

} // namespace

OutputsBeingWritten::OutputsBeingWritten() {
  ++outputs_being_written;
}
OutputsBeingWritten::~OutputsBeingWritten() {
  --outputs_being_written;
}

int run_interruptibly(const std::function<int()>& work) {
  Outcome outcome;
  std::thread worker;
  try {
    worker = std::thread([&] { run(work, outcome); });
  } catch (const std::system_error&) {
    return work(); // no memory for another thread: then without
  }
  {
    std::unique_lock lock(outcome.mutex);
    std::optional<Clock::time_point> signalled;
    while (!outcome.ended.wait_for(lock, poll_interval, [&] { return outcome.done; })) {
      const int signal = io::pending_signal();
      if (signal == 0 || outputs_being_written > 0) continue;
      if (!signalled) signalled = Clock::now();
      if (Clock::now() - *signalled > patience) leave(signal);
    }
  }
  worker.join();
  if (outcome.error) std::rethrow_exception(outcome.error);
  return outcome.result;
}

} // namespace iga::solve
