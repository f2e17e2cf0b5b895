#include "format/io/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <pthread.h>
#include <unistd.h>

namespace iga::io {

namespace {

std::atomic<int> arrived{0};
std::atomic<std::int64_t> arrived_at{0}; // s
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free,
              "the handler may only touch lock-free atomics");
constexpr std::int64_t same_event = 1; // s between two signals that tell the same

extern "C" void note_signal(int number) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  int none = 0;
  if (arrived.compare_exchange_strong(none, number))
    arrived_at = now.tv_sec;
  else if (now.tv_sec > arrived_at + same_event)
    _exit(128 + number);
}

sigset_t termination() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  return set;
}

void* wait_for_termination(void*) {
  const sigset_t set = termination();
  for (int number = 0;;)
    if (sigwait(&set, &number) == 0) note_signal(number);
  return nullptr;
}

void start_waiting_for_termination() {
  block_termination();
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, 1 << 18);
  pthread_t thread{};
  // Without memory for a thread the handler does what it did before.
  if (pthread_create(&thread, &attributes, wait_for_termination, nullptr) != 0) unblock_termination();
  pthread_attr_destroy(&attributes);
}

} // namespace

void block_termination() {
  const sigset_t set = termination();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void unblock_termination() {
  const sigset_t set = termination();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGQUIT}) sigaction(number, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  start_waiting_for_termination();
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
