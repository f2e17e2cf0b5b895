#include "solver/program/nonlinear_command.hpp"

#include "format/io/field_files.hpp"
#include "format/io/interrupt.hpp"
#include "format/io/output_claim.hpp"
#include "format/io/progress.hpp"
#include "format/io/results_io.hpp"
#include "format/io/sha256.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "format/model/glue_gap_ends.hpp"
#include "format/model/version.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/explicit/run/run_restart.hpp"
#include "solver/nonlinear/nonlinear_report.hpp"
#include "solver/nonlinear/nonlinear_restart.hpp"
#include "solver/report/model_notes.hpp"
#include "solver/report/model_summary.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <tbb/global_control.h>

namespace iga::solve {

namespace {

namespace fs = std::filesystem;

// Nothing where no results are written.
std::unique_ptr<io::OutputClaim> claim_outputs(const NonlinearCommand& command, const NonlinearRun& run,
                                               const fs::path& output) {
  if (output.empty()) return nullptr;
  io::OutputPlan plan{{output, restart_path(output)}, {io::fields_folder(output)}};
  if (run.viewer) {
    plan.files.push_back(io::viewer_index(output));
    plan.folders.push_back(io::viewer_folder(output));
  }
  std::vector<fs::path> inputs{run.file};
  inputs.insert(inputs.end(), run.inputs.begin(), run.inputs.end());
  io::refuse_replaced_inputs(plan, inputs);
  const fs::path restart = restart_path(output);
  if (command.restart) {
    for (const auto& file : {restart, output})
      if (!fs::exists(file))
        throw InputError(
            fmt::format("{}: no restart: there is no such file; start the run without --restart", file.string()));
  } else {
    io::check_results_target(output, command.force);
    if (run.viewer) io::check_viewer_target(output, command.force);
    if (!command.force && fs::exists(restart))
      throw InputError(fmt::format("{}: exists, and a run that ends removes it; choose another name for the results, "
                                   "or add --force",
                                   restart.string()));
  }
  return std::make_unique<io::OutputClaim>(plan, inputs);
}

std::vector<InputFile> hashed(const NonlinearRun& run) {
  std::vector<InputFile> inputs;
  for (const fs::path& input : run.inputs) inputs.push_back({input.filename().string(), io::sha256_file(input)});
  return inputs;
}

/// The model as the run computes with it, and what its user should know.
struct LoadedModel {
  TrimmedModel model;
  std::vector<std::string> findings;
};

LoadedModel load_model(const NonlinearRun& run) {
  LoadedModel loaded{io::read_model(run.model), {}};
  const std::int64_t glued = count_cells(loaded.model).gap_end_cells;
  if (glued > 0) loaded.model = glue_gap_ends(std::move(loaded.model));
  const TrimmedModel& model = loaded.model;
  if (run.units && *run.units != model.length_unit)
    throw InputError(fmt::format("{}: its length unit is \"{}\", but the run says \"{}\"; convert the material and the "
                                 "loads, or make the model with igaprep --length-unit {}",
                                 run.model.string(), model.length_unit, *run.units, *run.units));
  if (run.words) loaded.findings.push_back(material_text(*run.words, summarise(model).volume));
  loaded.findings.insert(loaded.findings.end(), model.provenance.findings.begin(), model.provenance.findings.end());
  if (glued > 0) loaded.findings.push_back(glued_gap_ends_note(glued, model));
  return loaded;
}

Results head_of(const NonlinearCommand& command, const NonlinearRun& run, const SolutionSpace& space,
                const std::vector<InputFile>& inputs) {
  const ElasticMaterial material = small_strain(run.material.law);
  Results results;
  BodyResult body;
  body.name = nonlinear_body;
  body.model_file = inputs.front().name;
  body.model_sha256 = inputs.front().sha256;
  body.law = run.material.name;
  body.mass = name_of(MassType::Consistent);
  body.light_functions = name_of(space.treatment().remedy);
  body.light_threshold = space.treatment().threshold;
  body.unknowns = space.num_unknowns();
  body.density = material.density;
  ResultsHeader& head = results.header;
  head.analysis = "nonlinear";
  head.title = space.model().title;
  head.length_unit = space.model().length_unit;
  head.model_file = body.model_file;
  head.model_sha256 = body.model_sha256;
  head.light_functions = body.light_functions;
  head.light_threshold = body.light_threshold;
  head.unknowns = body.unknowns;
  head.density = body.density;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) head.stiffness[static_cast<std::size_t>(6 * i + j)] = material.C(i, j);
  Provenance& p = head.provenance;
  p.producer = "igasolve";
  p.version = program_version();
  p.command_line = command.text;
  p.inputs = inputs;
  p.inputs.push_back({run.file.filename().string(), io::sha256_file(run.file)});
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                          fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  results.bodies.push_back(std::move(body));
  return results;
}

/// A run on its way: after each load step the results file holds it, and the restart file the state.
class Run {
 public:
  Run(const NonlinearRun& run, NonlinearStatics& statics, NonlinearOutputs& outputs, NonlinearRestart restart,
      io::Progress& progress)
      : run_(run), statics_(statics), outputs_(outputs), restart_(std::move(restart)), progress_(progress) {}

  /// 0, or the number of the signal that ended it. @throws NumericalError
  int go(std::vector<StepReport>& steps) {
    const int count = run_.newton.steps;
    progress_.start("load steps");
    int next = static_cast<int>(std::floor(statics_.factor() * count + 1e-9)) + 1;
    try {
      for (; next <= count; ++next) {
        steps.push_back(statics_.advance(static_cast<double>(next) / count, [&](const std::string& what) {
          progress_.update(next - 1, count, [&] { return what; });
        }));
        outputs_.add(steps.back());
        keep_state();
      }
    } catch (const io::Interrupted&) {
      progress_.finish();
      return io::pending_signal();
    } catch (const NumericalError& error) {
      progress_.finish();
      const std::string kept =
          outputs_.path().empty() || outputs_.series().time.empty()
              ? ""
              : fmt::format("; {} holds what was found until the load factor {:.6g}, and --restart goes on from there",
                            outputs_.path().string(), outputs_.series().time.back());
      throw NumericalError(fmt::format("{}; more load steps ([nonlinear] steps), smaller loads, supports that hold the "
                                       "part, smaller spans where it is crushed{}",
                                       error.what(), kept));
    }
    progress_.finish();
    return 0;
  }

 private:
  void keep_state() {
    if (outputs_.path().empty()) return;
    restart_.state = statics_.save();
    restart_.rows = static_cast<std::int64_t>(outputs_.series().time.size());
    write_restart(restart_path(outputs_.path()), restart_);
  }

  const NonlinearRun& run_;
  NonlinearStatics& statics_;
  NonlinearOutputs& outputs_;
  NonlinearRestart restart_;
  io::Progress& progress_;
};

} // namespace

int run_nonlinear(const NonlinearCommand& command) {
  const NonlinearRun run = read_nonlinear_run(command.run_file);
  const fs::path output = command.output.value_or(run.output);
  if (command.restart && output.empty())
    throw InputError("--restart goes on with the restart file beside the results; add -o out.h5");
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  const auto claim = claim_outputs(command, run, output);
  const bool quiet = command.style == ReportStyle::Quiet;
  const auto warn = [quiet](const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      if (!quiet) io::write_message(fmt::format("igasolve: warning: {}\n", text));
  };
  io::Progress progress(io::progress_style(quiet));
  Timings timings;
  Stopwatch watch(timings);
  const LoadedModel loaded = load_model(run);
  const ElasticMaterial material = small_strain(run.material.law);
  std::vector<std::string> warnings = run.warnings;
  const auto add = [&warnings](const std::vector<std::string>& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  };
  add(model_warnings(loaded.model, material.density == 1 ? nullptr : &material));
  if (run.locking == Locking::None)
    if (const auto locks = locking_warning(material, loaded.model.grid)) add({*locks});
  watch.stage("read");
  const SolutionSpace space(loaded.model, run.light);
  add(space.warnings());
  if (const auto joined = joined_bodies_warning(space)) add({*joined});
  NonlinearStatics statics(run, space);
  add(statics.warnings());
  warn(warnings);
  watch.stage("preparation");

  const std::vector<InputFile> inputs = hashed(run);
  NonlinearOutputs outputs(run, statics, output, head_of(command, run, space, inputs));
  outputs.header().provenance.findings = loaded.findings;
  outputs.header().provenance.warnings = warnings;
  NonlinearRestart restart{program_version(), inputs, settings_to_keep(run), {}, 0};
  if (command.restart) {
    const fs::path file = restart_path(output);
    const NonlinearRestart before = read_nonlinear_restart(file);
    check_restart(before, restart, file);
    try {
      statics.load(before.state);
      outputs.resume(io::read_results(output), static_cast<std::size_t>(before.rows));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
  } else {
    outputs.begin();
  }
  std::vector<StepReport> steps;
  const int signal = Run(run, statics, outputs, std::move(restart), progress).go(steps);
  watch.stage("load steps");
  const std::vector<std::string> of_steps = step_warnings(run, std::ranges::min(loaded.model.grid.span_size()), steps);
  warn(of_steps);
  add(of_steps);
  if (signal != 0) {
    const bool kept = !output.empty() && !outputs.series().time.empty();
    io::write_message(
        fmt::format("igasolve: interrupted at the load factor {:.6g}{}\n", statics.factor(),
                    kept ? fmt::format("; {} holds the steps so far, {} the last state: add --restart to go on",
                                       output.string(), restart_path(output).string())
                         : "; no step was written"));
    return 128 + signal;
  }
  outputs.header().provenance.warnings = warnings;
  outputs.header().provenance.timings = timings;
  outputs.publish();
  if (!output.empty()) {
    std::error_code ignored;
    fs::remove(restart_path(output), ignored);
  }
  if (quiet) return io::exit_done;
  const NonlinearOutcome outcome{run, statics, outputs, steps, timings, loaded.findings, warnings};
  if (command.style == ReportStyle::Json)
    io::write_report(fmt::format("{}\n", nonlinear_json(outcome)));
  else
    io::write_report(nonlinear_text(outcome));
  return io::exit_done;
}

} // namespace iga::solve
