#include "format/io/progress.hpp"

#include "format/io/standard_streams.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace iga::io {

namespace {

constexpr double bar_interval = 0.1;  // s; faster than the eye follows would only cost
constexpr double line_interval = 5.0; // s; a log should stay readable
constexpr std::int64_t bar_width = 30;

std::string time_left(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 60) return fmt::format("{} s left", s);
  if (s < 3600) return fmt::format("{} min {:02} s left", s / 60, s % 60);
  return fmt::format("{} h {:02} min left", s / 3600, (s / 60) % 60);
}

} // namespace

ProgressStyle progress_style(bool quiet) {
  if (quiet) return ProgressStyle::None;
  return isatty(STDERR_FILENO) ? ProgressStyle::Bar : ProgressStyle::Lines;
}

void Progress::start(const std::string& stage) {
  finish();
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  begin_ = last_ = Clock::now();
  noted_ = false;
  if (style_ == ProgressStyle::Lines) write_message(fmt::format("{} …\n", stage_));
  if (style_ == ProgressStyle::Bar) write_message(fmt::format("\r\033[K{} …", stage_));
}

void Progress::update(std::int64_t done, std::int64_t total) {
  if (style_ == ProgressStyle::None || total <= 0) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const double interval = style_ == ProgressStyle::Bar ? bar_interval : line_interval;
  if (stage_.empty() || std::chrono::duration<double>(now - last_).count() < interval) return;
  last_ = now;
  show(done, total, std::chrono::duration<double>(now - begin_).count(), {});
}

void Progress::update(std::int64_t done, std::int64_t total, const std::function<std::string()>& note, bool at_once) {
  if (style_ == ProgressStyle::None || total <= 0) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const double interval = style_ == ProgressStyle::Bar ? bar_interval : line_interval;
  if (stage_.empty()) return;
  if (noted_ && !at_once && std::chrono::duration<double>(now - last_).count() < interval) return;
  last_ = now;
  noted_ = true;
  show(done, total, std::chrono::duration<double>(now - begin_).count(), note());
}

void Progress::show(std::int64_t done, std::int64_t total, double elapsed, const std::string& note) {
  const double share = static_cast<double>(done) / static_cast<double>(total);
  const std::string left = done > 0 ? ", " + time_left(elapsed * (1 - share) / share) : "";
  const std::string text = note.empty() ? "" : "; " + note;
  if (style_ == ProgressStyle::Bar) {
    const std::int64_t filled = bar_width * done / total;
    write_message(fmt::format("\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %{}{}", stage_, "", filled, "", bar_width - filled,
                              100 * share, left, text));
  } else {
    write_message(fmt::format("{}: {:.0f} %{}{}\n", stage_, 100 * share, left, text));
  }
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::Bar && !stage_.empty()) {
    write_message("\r\033[K");
  }
  stage_.clear();
}

} // namespace iga::io
