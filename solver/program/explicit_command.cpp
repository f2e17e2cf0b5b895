#include "solver/program/explicit_command.hpp"

#include "format/io/field_files.hpp"
#include "format/io/interrupt.hpp"
#include "format/io/output_claim.hpp"
#include "format/io/results_io.hpp"
#include "format/io/sha256.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "format/model/version.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/explicit/run/explicit_report.hpp"

#include <chrono>
#include <fmt/chrono.h>
#include <tbb/global_control.h>

namespace iga::solve {

namespace {

std::vector<InputFile> hashed(const ExplicitRun& run) {
  std::vector<InputFile> inputs{{run.file.filename().string(), io::sha256_file(run.file)}};
  for (const RunInput& input : run.inputs)
    inputs.push_back({input.file.filename().string(), io::sha256_file(input.file)});
  return inputs;
}

void check_targets(const ExplicitCommand& command, const ExplicitRun& run, const std::filesystem::path& output) {
  const auto restart = restart_path(output);
  if (command.restart) {
    for (const auto& file : {restart, output})
      if (!std::filesystem::exists(file))
        throw InputError(
            fmt::format("{}: no restart: there is no such file; start the run without --restart", file.string()));
    return;
  }
  io::check_results_target(output, command.force);
  if (run.out.viewer) io::check_viewer_target(output, command.force);
  if (!command.force && std::filesystem::exists(restart))
    throw InputError(fmt::format("{}: exists, and a run that ends removes it; choose another name for the results, or "
                                 "add --force",
                                 restart.string()));
}

io::OutputClaim claim_outputs(const ExplicitCommand& command, const ExplicitRun& run,
                              const std::filesystem::path& output) {
  io::OutputPlan plan{{output, restart_path(output)}, {io::fields_folder(output)}};
  if (run.out.viewer) {
    plan.files.push_back(io::viewer_index(output));
    plan.folders.push_back(io::viewer_folder(output));
  }
  std::vector<std::filesystem::path> inputs{run.file};
  for (const RunInput& input : run.inputs) inputs.push_back(input.file);
  io::refuse_replaced_inputs(plan, inputs);
  check_targets(command, run, output);
  return {plan, inputs};
}

Results head_of(const ExplicitCommand& command, const ExplicitScene& scene, const std::vector<InputFile>& inputs) {
  const ExplicitRun& run = scene.run();
  Results results;
  for (std::size_t b = 0; b < scene.num_bodies(); ++b) {
    const BodyRun& asked = run.bodies[b];
    const SolutionSpace& space = scene.body(b).space();
    BodyResult body;
    body.name = asked.body.name;
    body.model_file = asked.model.filename().string();
    body.model_sha256 = io::sha256_file(asked.model);
    body.law = asked.material.name;
    body.mass = name_of(asked.body.mass);
    body.light_functions = name_of(space.treatment().remedy);
    body.light_threshold = space.treatment().threshold;
    body.unknowns = space.num_unknowns();
    body.density = scene.body(b).small_strain().density;
    results.bodies.push_back(std::move(body));
  }
  // The head of all analyses speaks of one model: the first body's.
  const BodyResult& first = results.bodies.front();
  ResultsHeader& head = results.header;
  head.analysis = "explicit";
  head.title = scene.body(0).space().model().title;
  head.length_unit = scene.body(0).space().model().length_unit;
  head.model_file = first.model_file;
  head.model_sha256 = first.model_sha256;
  head.light_functions = first.light_functions;
  head.light_threshold = first.light_threshold;
  head.unknowns = first.unknowns;
  head.density = first.density;
  const auto& C = scene.body(0).small_strain().C;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) head.stiffness[static_cast<std::size_t>(6 * i + j)] = C(i, j);
  Provenance& p = head.provenance;
  p.producer = "igasolve";
  p.version = program_version();
  p.command_line = command.text;
  p.inputs.assign(inputs.begin() + 1, inputs.end());
  p.inputs.push_back(inputs.front());
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                          fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  return results;
}

void remove_restart(const std::filesystem::path& output) {
  std::error_code ignored;
  std::filesystem::remove(restart_path(output), ignored);
}

} // namespace

int run_explicit(const ExplicitCommand& command) {
  const ExplicitRun run = read_explicit_run(command.run_file);
  const std::filesystem::path output = command.output.value_or(run.output);
  if (output.empty())
    throw InputError(fmt::format("{}: no results file is given; add -o out.h5, or file = \"out.h5\" in [output]",
                                 command.run_file.string()));
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  const io::OutputClaim claim = claim_outputs(command, run, output);
  const bool quiet = command.style == ReportStyle::Quiet;
  io::Progress progress(io::progress_style(quiet));
  Timings timings;
  Stopwatch watch(timings);
  progress.start("reading models");
  const std::vector<InputFile> inputs = hashed(run);
  std::optional<RestartState> restart;
  std::vector<std::string> warnings;
  if (command.restart) { // before hours of work
    restart = read_restart(restart_path(output));
    warnings = check_restart(*restart, run, inputs, restart_path(output), program_version());
  }
  ExplicitScene scene(run);
  warnings.insert(warnings.end(), scene.warnings().begin(), scene.warnings().end());
  watch.stage("read");
  SeriesRecorder recorder(scene);
  RunOutputs outputs(scene, output, head_of(command, scene, inputs));
  const auto warn = [quiet](const std::string& text) {
    if (!quiet) io::write_message(fmt::format("igasolve: warning: {}\n", text));
  };
  ExplicitLoop loop({scene, recorder, outputs, progress, inputs, warn});
  outputs.header().provenance.findings = scene.findings();
  outputs.header().provenance.warnings = warnings;
  if (restart) {
    Results before = io::read_results(output);
    if (!before.time_series || !before.fields)
      throw InputError(fmt::format("{}: holds no explicit run to go on with", output.string()));
    try {
      scene.load(restart->state, restart->limits);
      recorder.resume(std::move(*before.time_series), static_cast<std::size_t>(restart->rows), restart->sums);
      outputs.resume(*before.fields, static_cast<std::size_t>(restart->fields));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", restart_path(output).string(), error.what()));
    }
    loop.resume();
  } else {
    scene.check_start();
    progress.start("time step");
    scene.find_limits();
    scene.start();
    watch.stage("start");
    remove_restart(output);
    loop.begin();
  }
  outputs.header().provenance.timings = timings;
  for (const std::string& warning : warnings) warn(warning);
  if (command.profile) scene.integrator().clock().measure_cpu();
  const int signal = loop.run();
  if (signal != 0) {
    const bool can_go_on = std::filesystem::exists(restart_path(output));
    io::write_message(fmt::format(
        "igasolve: interrupted at t = {:.6g}; {} holds the results so far{}\n", scene.integrator().time(),
        output.string(),
        can_go_on ? fmt::format(", {} the state: add --restart to go on", restart_path(output).string()) : ""));
    return 128 + signal;
  }
  watch.stage("stepping");
  const std::vector<std::string> of_run = loop.warnings();
  warnings.insert(warnings.end(), of_run.begin(), of_run.end());
  outputs.header().provenance.warnings = warnings;
  outputs.header().provenance.timings = timings;
  outputs.publish(recorder.series());
  outputs.wait();
  remove_restart(output);
  if (quiet) return io::exit_done;
  for (const std::string& warning : of_run) warn(warning);
  const ExplicitOutcome outcome{scene, recorder, outputs, loop, timings, warnings};
  if (command.style == ReportStyle::Json)
    io::write_report(fmt::format("{}\n", explicit_json(outcome)));
  else
    io::write_report(explicit_text(outcome));
  return io::exit_done;
}

} // namespace iga::solve
