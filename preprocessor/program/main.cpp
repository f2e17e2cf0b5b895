// igaprep: surface → interchange file. The command line, the pipeline, the report, the exit code.
#include "format/io/interrupt.hpp"
#include "format/io/json_text.hpp"
#include "format/io/run_tool.hpp"
#include "format/io/standard_streams.hpp"
#include "format/model/errors.hpp"
#include "preprocessor/program/assembly.hpp"
#include "preprocessor/program/cad_list.hpp"
#include "preprocessor/program/command_line.hpp"
#include "preprocessor/program/pipeline.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <tbb/global_control.h>

namespace {

void warn(const iga::prep::CommandLine& line, const std::vector<std::string>& warnings, const std::string& of = "") {
  if (line.quiet) return;
  for (const std::string& warning : warnings)
    iga::io::write_message(fmt::format("igaprep: warning: {}{}\n", of, warning));
}

int list(const iga::prep::Settings& settings, const iga::prep::CommandLine& line) {
  using namespace iga;
  const std::string file = settings.input.string();
  if (!std::filesystem::exists(settings.input)) throw InputError(fmt::format("{}: no such file", file));
  if (!prep::is_cad_file(settings.input))
    throw InputError(
        fmt::format("{}: --list is for CAD files (STEP, IGES, BREP); the regions of a model file are listed by "
                    "igasolve info",
                    file));
  const prep::CadModel cad = prep::list_cad_file(settings, [] { return io::pending_signal() != 0; });
  io::stop_if_interrupted();
  warn(line, cad.warnings);
  io::write_report(line.json ? prep::cad_list_json(cad, file, line.list_edges) + "\n"
                             : prep::cad_list_text(cad, file, line.list_edges));
  return io::exit_done;
}

int exit_code(const iga::prep::PrepReport& made) {
  return made.interrupted_by == 0 ? iga::io::exit_done : 128 + made.interrupted_by;
}

// The reports of all models one after the other.
int report(const iga::prep::CommandLine& line, const iga::prep::AssemblyReport& made) {
  using namespace iga;
  std::vector<std::string> models;
  int code = io::exit_done;
  for (const prep::PrepReport& model : made.models) {
    warn(line, model.warnings, model.output + ": ");
    models.push_back(line.json ? prep::json_report(model) : prep::human_report(model) + "\n");
    code = std::max(code, exit_code(model));
  }
  if (line.json)
    io::write_report(fmt::format("{{\"run_file\": {}, \"run_file_kept\": {}, \"models\": [{}]}}\n",
                                 io::json(made.run_file.string()), made.run_file_kept, fmt::join(models, ", ")));
  else if (!line.quiet)
    io::write_report(fmt::format("{}{} models; run file {}{}\n", fmt::join(models, ""), made.models.size(),
                                 made.run_file.string(),
                                 made.run_file_kept ? " stood there already and stays as it is" : ", to be filled in"));
  return code;
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
  const prep::RunInfo info{line->text, line->force, line->settings_file};
  if (settings.output_is_folder) return report(*line, prep::run_assembly(settings, info, progress));
  const prep::PrepReport made = prep::run_pipeline(settings, info, progress);
  warn(*line, made.warnings);
  if (line->json)
    io::write_report(fmt::format("{}\n", prep::json_report(made)));
  else if (!line->quiet)
    io::write_report(prep::human_report(made));
  return exit_code(made);
}

} // namespace

int main(int argc, char** argv) {
  return iga::io::run_tool("igaprep", [&] { return run(argc, argv); });
}
