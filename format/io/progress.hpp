// What the user sees while a tool works: a bar with the time left on a terminal, plain lines in a pipe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace iga::io {

enum class ProgressStyle { None, Lines, Bar };

/// Bar where stderr is a terminal, else lines; None where the user asked for quiet.
ProgressStyle progress_style(bool quiet);

/// Progress of consecutive stages, on stderr.
class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void start(const std::string& stage);
  /// Share of the running stage that is done; may be called from any thread.
  void update(std::int64_t done, std::int64_t total);
  /// The same with a text behind it, which is asked for only where it will be shown; the first one of a stage is shown
  /// at once, and so is one with `now`.
  void update(std::int64_t done, std::int64_t total, const std::function<std::string()>& note, bool now = false);
  /// Ends the running stage: a bar is wiped out.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::int64_t done, std::int64_t total, double elapsed, const std::string& note);

  ProgressStyle style_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point begin_, last_;
  bool noted_ = false; ///< a text was shown in this stage
};

} // namespace iga::io
