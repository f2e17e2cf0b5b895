// What the reports of all analyses share: lines for people, members for scripts, the head of the results file.
#pragma once

#include "format/io/json_text.hpp"
#include "format/model/results.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/report/analysis_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

using Timings = std::vector<std::pair<std::string, double>>;

/// An analysis on its way: settings, model, what took how long, what the user should know.
struct AnalysisRun {
  const AnalysisCommand& command;
  RunSettings settings;
  TrimmedModel model;
  Timings timings;
  std::vector<std::string> warnings; ///< already on stderr; the report repeats them
};

/// Prints the warnings to stderr at once (unless quiet) and keeps them for report and results file.
void warn(AnalysisRun& run, const std::vector<std::string>& warnings);
/// Warns where the model joins bodies that the surface has apart.
void warn_of_joined_bodies(AnalysisRun& run, const SolutionSpace& space);

/// Text report: one line per key; further lines of a text are indented.
class TextReport {
 public:
  template <class... Args> void line(std::string_view key, fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), "{:<13}{}\n", key,
                   fmt::join(lines_of(fmt::format(text, std::forward<Args>(args)...)), "\n             "));
  }
  void lines(std::string_view key, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) line(key, "{}", text);
  }
  template <class... Args> void row(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), "{}\n", fmt::format(text, std::forward<Args>(args)...));
  }
  std::string text() const { return fmt::to_string(buffer_); }

 private:
  static std::vector<std::string> lines_of(const std::string& text);

  fmt::memory_buffer buffer_;
};

/// Of this process so far, MiB.
double peak_memory_mib();

/// Model, spans, points, unknowns, light functions.
void add_model(TextReport& report, const AnalysisRun& run, const SolutionSpace& space);
void add_model(io::JsonObject& report, const AnalysisRun& run, const SolutionSpace& space);
/// Regions of supports: area and centroid of what was chosen.
void add_regions(TextReport& report, const std::vector<RegionReport>& regions);
std::vector<io::JsonObject> json_of(const std::vector<RegionReport>& regions);
/// Results file, timings, peak memory, findings of the model, warnings: the end of every report.
void add_end(TextReport& report, const AnalysisRun& run);
void add_end(io::JsonObject& report, const AnalysisRun& run);

/// The head of a results file. Reads the model file once more for its checksum.
ResultsHeader results_header(const AnalysisRun& run, const char* analysis, const SolutionSpace& space);
/// Writes the results file and, if asked for, the viewer files beside it. @throws InputError
void write_outputs(const AnalysisRun& run, const Results& results);

/// Prints the report to stdout unless quiet.
void print_report(const AnalysisRun& run, const std::string& report);

/// The analyses; each prints its report and returns the exit code.
int eigen_command(AnalysisRun& run);
int timestep_command(AnalysisRun& run);
int static_command(AnalysisRun& run);

} // namespace iga::solve
