// Runs an analysis from settings to report.
#include "format/io/field_files.hpp"
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

void check_units(const AnalysisRun& run, std::size_t b) {
  const std::filesystem::path& file = run.bodies[b].file.model;
  const std::string &unit = run.models[b].length_unit, &first = run.models[0].length_unit;
  if (const auto& asked = run.settings.units; asked && *asked != unit)
    throw InputError(fmt::format("{}: its length unit is \"{}\", but the run says \"{}\"; convert the material and the "
                                 "loads, or make the model with igaprep --length-unit {}",
                                 file.string(), unit, *asked, *asked));
  if (unit != first)
    throw InputError(
        fmt::format("{}: its length unit is \"{}\", but that of {} is \"{}\"; make the models with the same "
                    "igaprep --length-unit",
                    file.string(), unit, run.bodies[0].file.model.string(), first));
}

// The models of all bodies, in their places.
void read_models(AnalysisRun& run) {
  for (std::size_t b = 0; b < run.bodies.size(); ++b) {
    const RunBody& body = run.bodies[b];
    TrimmedModel model = io::read_model(body.file.model);
    const bool moved = !(body.file.place == Placement{});
    run.models.push_back(moved ? placed(std::move(model), body.file.place) : std::move(model));
    check_units(run, b);
    warn(run, prefixed(body.file.model.filename().string(),
                       model_warnings(run.models[b], body.has_density ? &body.material : nullptr)));
    if (run.command.analysis != Analysis::Heat && run.command.analysis != Analysis::Timestep)
      if (const auto locks = locking_warning(body.material, run.models[b].grid))
        warn(run, prefixed(body.file.model.filename().string(), {*locks}));
  }
}

// Before hours of work. Nothing where no results are written.
std::unique_ptr<io::OutputClaim> claim_outputs(const RunSettings& run, const AnalysisCommand& command) {
  if (run.output.empty()) return nullptr;
  io::OutputPlan plan{{run.output}, {}};
  if (run.viewer) {
    plan.files.push_back(io::viewer_index(run.output));
    plan.folders.push_back(io::viewer_folder(run.output));
  }
  if (run.bodies.size() > 1) plan.folders.push_back(io::fields_folder(run.output));
  std::vector<std::filesystem::path> inputs;
  for (const RunBody& body : bodies_of(run)) inputs.push_back(body.file.model);
  if (!command.run_file.empty()) inputs.push_back(command.run_file);
  io::refuse_replaced_inputs(plan, inputs);
  io::check_results_target(run.output, command.force);
  if (run.viewer) io::check_viewer_target(run.output, command.force);
  return std::make_unique<io::OutputClaim>(plan, inputs);
}

} // namespace

int run_analysis(const AnalysisCommand& command) {
  AnalysisRun run{command, validate_run(complete_materials(command.typed), command.analysis), {}, {}, {}, {}};
  run.bodies = bodies_of(run.settings);
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  const auto claim = claim_outputs(run.settings, command);
  {
    Stopwatch watch(run.timings);
    read_models(run);
    watch.stage("read");
  }
  io::Progress progress(io::progress_style(command.style == ReportStyle::Quiet));
  run.settings.progress = &progress;
  return run_interruptibly([&] {
    switch (command.analysis) {
    case Analysis::Eigen:
      return eigen_command(run);
    case Analysis::Timestep:
      return timestep_command(run);
    case Analysis::Heat:
      return heat_command(run);
    case Analysis::Harmonic:
      return harmonic_command(run);
    case Analysis::Random:
      return random_command(run);
    case Analysis::Transient:
      return transient_command(run);
    case Analysis::Buckling:
      return buckling_command(run);
    default:
      return static_command(run);
    }
  });
}

} // namespace iga::solve
