// Runs an analysis from settings to report.
#include "format/io/progress.hpp"
#include "format/io/results_io.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis_report.hpp"
#include "solver/blas_threads.hpp"
#include "solver/interruptible.hpp"
#include "solver/stopwatch.hpp"

#include <tbb/global_control.h>

namespace iga::solve {

namespace {

void check_units(const RunSettings& run, const TrimmedModel& model) {
  if (run.units && *run.units != model.length_unit)
    throw InputError(fmt::format("{}: its length unit is \"{}\", but the run says \"{}\"; convert the material and the "
                                 "loads, or make the model with igaprep --length-unit {}",
                                 run.model.string(), model.length_unit, *run.units, *run.units));
}

} // namespace

int run_analysis(const AnalysisCommand& command) {
  AnalysisRun run{command, validate_run(command.typed, command.analysis), {}, {}, {}};
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  if (!run.settings.output.empty()) { // before hours of work
    io::check_results_target(run.settings.output, command.force);
    if (run.settings.viewer) io::check_viewer_target(run.settings.output, command.force);
  }
  {
    Stopwatch watch(run.timings);
    run.model = io::read_model(run.settings.model);
    watch.stage("read");
  }
  check_units(run.settings, run.model);
  io::Progress progress(io::progress_style(command.style == ReportStyle::Quiet));
  run.settings.progress = &progress;
  return run_interruptibly([&] {
    switch (command.analysis) {
    case Analysis::Eigen:
      return eigen_command(run);
    case Analysis::Timestep:
      return timestep_command(run);
    default:
      return static_command(run);
    }
  });
}

} // namespace iga::solve
