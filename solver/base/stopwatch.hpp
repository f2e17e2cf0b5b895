// Names and seconds of the stages of an analysis.
#pragma once

#include "format/io/interrupt.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace iga::solve {

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<std::pair<std::string, double>>& timings) : timings_(timings) {}
  /// The time since the last stage ended belongs to this one; stages of one name are added up.
  /// @throws io::Interrupted if a signal arrived meanwhile: between stages there is nothing to lose
  void stage(const char* name) {
    io::stop_if_interrupted();
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    for (auto& [known, sum] : timings_)
      if (known == name) {
        sum += seconds;
        return;
      }
    timings_.emplace_back(name, seconds);
  }

 private:
  std::vector<std::pair<std::string, double>>& timings_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace iga::solve
