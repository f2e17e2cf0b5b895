// What the reports of all analyses share: lines for people, members for scripts, the head of the results file.
#pragma once

#include "format/io/json_text.hpp"
#include "format/model/results.hpp"
#include "solver/command_line.hpp"
#include "solver/run_settings.hpp"

#include <fmt/format.h>

namespace iga::solve {

using Timings = std::vector<std::pair<std::string, double>>;

/// An analysis on its way: settings, model, what took how long, what the user should know.
struct AnalysisRun {
  const AnalysisCommand& command;
  RunSettings settings;
  TrimmedModel model;
  Timings timings;
  std::vector<std::string> warnings;
};

/// Text report: one line per key.
class TextReport {
 public:
  template <class... Args> void line(std::string_view key, fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), "{:<13}{}\n", key, fmt::format(text, std::forward<Args>(args)...));
  }
  template <class... Args> void row(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), "{}\n", fmt::format(text, std::forward<Args>(args)...));
  }
  std::string text() const { return fmt::to_string(buffer_); }

 private:
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
/// Results file, timings, peak memory, warnings: the end of every report.
void add_end(TextReport& report, const AnalysisRun& run);
void add_end(io::JsonObject& report, const AnalysisRun& run);

/// The head of a results file. Reads the model file once more for its checksum.
ResultsHeader results_header(const AnalysisRun& run, const char* analysis, const SolutionSpace& space);
/// Writes the results file and, if asked for, the viewer files beside it. @throws InputError
void write_outputs(const AnalysisRun& run, const Results& results);

/// Prints warnings to stderr and the report to stdout, as the user asked.
void print_report(const AnalysisRun& run, const std::string& report);

/// The analyses; each prints its report and returns the exit code.
int eigen_command(AnalysisRun& run);
int timestep_command(AnalysisRun& run);
int static_command(AnalysisRun& run);

} // namespace iga::solve
