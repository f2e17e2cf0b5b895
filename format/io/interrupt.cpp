#include "format/io/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <unistd.h>

namespace iga::io {

namespace {

std::atomic<int> arrived{0};
static_assert(std::atomic<int>::is_always_lock_free, "the handler may only touch lock-free atomics");

extern "C" void note_signal(int number) {
  if (arrived.exchange(number) != 0) _exit(128 + number);
}

} // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A file that reaches the process's size limit is a failed write with a message, not a death.
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

int pending_signal() {
  return arrived.load();
}

int take_pending_signal() {
  return arrived.exchange(0);
}

void stop_if_interrupted() {
  if (pending_signal() != 0) throw Interrupted{};
}

} // namespace iga::io
