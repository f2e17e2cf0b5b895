// Where the time of a stepped run goes.
#pragma once

#include "solver/base/parallel.hpp"

#include <array>
#include <chrono>
#include <cstddef>

namespace iga::solve {

enum class Phase : std::size_t { Internal, Search, Touches, Contact, Loads, Nodes, StepControl, Output };

/// Times by phase, taken by the thread that leads the run: between two laps it was in one phase.
class PhaseClock {
 public:
  static constexpr std::array<const char*, 8> names{
      "internal forces",    "contact search", "touch list",   "contact forces",
      "loads and supports", "nodes",          "step control", "output"};
  static constexpr std::size_t num_phases = names.size();

  struct Times {
    double wall = 0;   ///< seconds
    double cpu = 0;    ///< of the leading thread, where that is measured
    double serial = 0; ///< part of it outside of parallel loops
  };

  /// Has laps also take the CPU time, inside and outside of parallel loops: some microseconds per step.
  void measure_cpu() {
    measures_cpu_ = true;
    ParallelTime::measure(true);
    all_at_start_ = process_cpu_seconds();
    restart();
  }
  bool measures_cpu() const { return measures_cpu_; }
  /// Of all threads since measure_cpu. Threads that look for work count as busy for a while.
  double cpu_of_all_threads() const { return process_cpu_seconds() - all_at_start_; }

  /// The time since the last lap belongs to no phase.
  void restart() {
    wall_ = Clock::now();
    if (!measures_cpu_) return;
    cpu_ = thread_cpu_seconds();
    parallel_ = ParallelTime::seconds();
  }
  /// The time since the last lap belongs to this phase.
  void lap(Phase phase) {
    Times& times = times_[static_cast<std::size_t>(phase)];
    const Clock::time_point wall = Clock::now();
    times.wall += std::chrono::duration<double>(wall - wall_).count();
    wall_ = wall;
    if (!measures_cpu_) return;
    const double cpu = thread_cpu_seconds(), parallel = ParallelTime::seconds();
    times.cpu += cpu - cpu_;
    times.serial += (cpu - cpu_) - (parallel - parallel_);
    cpu_ = cpu;
    parallel_ = parallel;
  }

  const std::array<Times, num_phases>& times() const { return times_; }
  Times total() const {
    Times sum;
    for (const Times& t : times_) {
      sum.wall += t.wall;
      sum.cpu += t.cpu;
      sum.serial += t.serial;
    }
    return sum;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::array<Times, num_phases> times_{};
  bool measures_cpu_ = false;
  Clock::time_point wall_ = Clock::now();
  double cpu_ = 0, parallel_ = 0, all_at_start_ = 0;
};

} // namespace iga::solve
