// Runs an analysis from settings to report.
#include "format/io/output_claim.hpp"
#include "format/io/progress.hpp"
#include "format/io/results_io.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "solver/base/interruptible.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/model_notes.hpp"

#include <memory>
#include <tbb/global_control.h>

namespace iga::solve {

namespace {

void check_units(const RunSettings& run, const TrimmedModel& model) {
  if (run.units && *run.units != model.length_unit)
    throw InputError(fmt::format("{}: its length unit is \"{}\", but the run says \"{}\"; convert the material and the "
                                 "loads, or make the model with igaprep --length-unit {}",
                                 run.model.string(), model.length_unit, *run.units, *run.units));
}

// Before hours of work. Nothing where no results are written.
std::unique_ptr<io::OutputClaim> claim_outputs(const RunSettings& run, const AnalysisCommand& command) {
  if (run.output.empty()) return nullptr;
  io::OutputPlan plan{{run.output}, {}};
  if (run.viewer) {
    plan.files.push_back(io::viewer_index(run.output));
    plan.folders.push_back(io::viewer_folder(run.output));
  }
  std::vector<std::filesystem::path> inputs{run.model};
  if (!command.run_file.empty()) inputs.push_back(command.run_file);
  io::refuse_replaced_inputs(plan, inputs);
  io::check_results_target(run.output, command.force);
  if (run.viewer) io::check_viewer_target(run.output, command.force);
  return std::make_unique<io::OutputClaim>(plan, inputs);
}

} // namespace

int run_analysis(const AnalysisCommand& command) {
  const CompletedRun complete = complete_material(command.typed);
  AnalysisRun run{command, validate_run(complete.typed, command.analysis), {}, {}, {}};
  run.settings.words.name = complete.named.name;
  run.settings.words.source = complete.named.source;
  run.settings.words.units = complete.units;
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  const auto claim = claim_outputs(run.settings, command);
  {
    Stopwatch watch(run.timings);
    run.model = io::read_model(run.settings.model);
    watch.stage("read");
  }
  check_units(run.settings, run.model);
  warn(run, prefixed(run.settings.model.filename().string(),
                     model_warnings(run.model, complete.typed.rho ? &run.settings.material : nullptr)));
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
