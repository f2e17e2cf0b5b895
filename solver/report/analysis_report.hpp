// What the reports of all analyses share: lines for people, members for scripts, the head of the results file.
#pragma once

#include "format/io/json_text.hpp"
#include "format/model/results.hpp"
#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/output/surface_output.hpp"
#include "solver/report/analysis_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

using Timings = std::vector<std::pair<std::string, double>>;

/// An analysis on its way: settings, models, what took how long, what the user should know.
struct AnalysisRun {
  const AnalysisCommand& command;
  RunSettings settings;
  std::vector<RunBody> bodies;      ///< of the settings
  std::vector<TrimmedModel> models; ///< of the bodies, in their places
  Timings timings;
  std::vector<std::string> warnings; ///< already on stderr; the report repeats them
};

/// Prints the warnings to stderr at once (unless quiet) and keeps them for report and results file; each once, as
/// bodies that share a model file share its warnings.
void warn(AnalysisRun& run, const std::vector<std::string>& warnings);
/// Warns where a model joins bodies that the surface has apart.
void warn_of_joined_bodies(AnalysisRun& run, const BodySystem& system);

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

/// Models, spans, points, unknowns, light functions.
void add_models(TextReport& report, const AnalysisRun& run, const BodySystem& system);
void add_models(io::JsonObject& report, const AnalysisRun& run, const BodySystem& system);
/// Regions of supports: area and centroid of what was chosen.
void add_regions(TextReport& report, const std::vector<RegionReport>& regions);
std::vector<io::JsonObject> json_of(const std::vector<RegionReport>& regions);
/// Ties: area tied and largest gap. Nothing where there is none.
void add_ties(TextReport& report, const std::vector<TieReport>& ties);
std::vector<io::JsonObject> json_of(const std::vector<TieReport>& ties);
/// Which solver was taken and why.
io::JsonObject json_of(const SolverReport& solver);
/// Springs and added masses: where they act, what they are. Nothing where there is none.
void add_attached(TextReport& report, const AttachedParts& attached);
void add_attached(io::JsonObject& report, const AttachedParts& attached);
/// "spring 'mount' on 'plate' at (0, 0, 1): …", without the first word.
std::string text_of(const AttachedParts::OfSpring& spring);
std::string text_of(const AttachedParts::OfMass& mass);
/// " of body 'a'"; nothing where there is one body.
std::string of_body(const BodySystem& system, std::size_t body);
/// Results file, timings, peak memory, findings of the model, warnings: the end of every report.
void add_end(TextReport& report, const AnalysisRun& run);
void add_end(io::JsonObject& report, const AnalysisRun& run);

/// The head of a results file, and where there are several bodies their list. Reads the model files once more for their
/// checksums.
Results results_head(const AnalysisRun& run, const char* analysis, const BodySystem& system);
/// Adds the fields of all bodies: to the results themselves where there is one, else to `parts`.
/// @param unknowns  (num_unknowns of the system × steps)
void add_fields(const AnalysisRun& run, const BodySystem& system, const Eigen::Ref<const Eigen::MatrixXd>& unknowns,
                const std::vector<double>& steps, Fields fields, Results& results);
/// Writes the results file, the field files of several bodies and, if asked for, the viewer files beside it.
/// @throws InputError
void write_outputs(const AnalysisRun& run, Results& results);

/// Prints the report to stdout unless quiet.
void print_report(const AnalysisRun& run, const std::string& report);

/// The analyses; each prints its report and returns the exit code.
int eigen_command(AnalysisRun& run);
int timestep_command(AnalysisRun& run);
int static_command(AnalysisRun& run);
int heat_command(AnalysisRun& run);
int harmonic_command(AnalysisRun& run);
int random_command(AnalysisRun& run);
int transient_command(AnalysisRun& run);
int buckling_command(AnalysisRun& run);

} // namespace iga::solve
