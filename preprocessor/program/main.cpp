// igaprep: surface → interchange file. The command line, the pipeline, the report, the exit code.
#include "format/io/interrupt.hpp"
#include "format/io/run_tool.hpp"
#include "format/io/standard_streams.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/program/cad_list.hpp"
#include "preprocessor/program/command_line.hpp"
#include "preprocessor/program/pipeline.hpp"

#include <fmt/format.h>
#include <optional>
#include <tbb/global_control.h>

namespace {

int list(const iga::prep::Settings& settings, const iga::prep::CommandLine& line) {
  using namespace iga;
  const std::string file = settings.input.string();
  if (!std::filesystem::exists(settings.input)) throw InputError(fmt::format("{}: no such file", file));
  if (!prep::is_cad_file(settings.input))
    throw InputError(fmt::format("{}: --list is for CAD files (STEP, IGES, BREP); the regions of a model file are listed by "
                                 "igasolve info",
                                 file));
  const prep::CadModel cad = prep::list_cad_file(settings, [] { return io::pending_signal() != 0; });
  io::stop_if_interrupted();
  for (const std::string& warning : cad.warnings) io::write_message(fmt::format("igaprep: warning: {}\n", warning));
  io::write_report(line.json ? prep::cad_list_json(cad, file, line.list_edges) + "\n"
                             : prep::cad_list_text(cad, file, line.list_edges));
  return io::exit_done;
}

int run(int argc, const char* const* argv) {
  using namespace iga;
  const std::optional<prep::CommandLine> line = prep::parse_command_line(argc, argv);
  if (!line) return io::exit_done;
  const prep::Settings settings = prep::validate(line->typed);
  std::optional<tbb::global_control> threads;
  if (line->threads)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(*line->threads));
  io::install_signal_handlers();
  if (line->list || line->list_edges) return list(settings, *line);
  io::Progress progress(io::progress_style(line->quiet));
  const prep::PrepReport report =
      prep::run_pipeline(settings, {line->text, line->force, line->settings_file}, progress);
  if (!line->quiet)
    for (const std::string& warning : report.warnings)
      io::write_message(fmt::format("igaprep: warning: {}\n", warning));
  if (line->json)
    io::write_report(fmt::format("{}\n", prep::json_report(report)));
  else if (!line->quiet)
    io::write_report(prep::human_report(report));
  return report.interrupted_by == 0 ? io::exit_done : 128 + report.interrupted_by;
}

} // namespace

int main(int argc, char** argv) {
  return iga::io::run_tool("igaprep", [&] { return run(argc, argv); });
}
