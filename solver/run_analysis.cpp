// Runs an analysis from settings to report.
#include "format/io/progress.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/command_line.hpp"

#include <fmt/format.h>
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
  const RunSettings run = validate_run(command.typed, command.analysis);
  std::optional<tbb::global_control> threads;
  if (command.threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*command.threads));
  const TrimmedModel model = io::read_model(run.model);
  check_units(run, model);
  return io::exit_done;
}

} // namespace iga::solve
