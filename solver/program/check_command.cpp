// igasolve check: every problem of a model file in full, the first one of a results file.
#include "format/io/json_text.hpp"
#include "format/io/results_io.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "format/model/points_outside.hpp"
#include "solver/program/commands.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

Provenance check_model(const std::filesystem::path& file, std::vector<std::string>& problems,
                       std::vector<std::string>& notes) {
  TrimmedModel model = io::load_model(file);
  problems = check(model);
  if (model.surface.accepted_leak > 0)
    notes.push_back(
        fmt::format("the surface leaks (accepted: {:.3g} span volumes); its areas, its closedness and whether "
                    "points lie inside it were not checked",
                    model.surface.accepted_leak));
  else if (problems.empty())
    if (const std::string outside = describe(find_points_outside(model), model); !outside.empty())
      problems.push_back(outside);
  return std::move(model.provenance);
}

} // namespace

int run_check(const ModelCommand& command) {
  std::vector<std::string> problems, notes;
  Provenance provenance;
  try {
    if (io::holds_results(command.model))
      provenance = io::read_results(command.model).header.provenance; // refuses what is wrong
    else
      provenance = check_model(command.model, problems, notes);
  } catch (const FormatError& error) {
    problems.push_back(error.what());
  }
  const std::string file = command.model.string();
  if (command.style == ReportStyle::Json) {
    io::JsonObject report;
    report.add("file", file).add("sound", problems.empty()).add("problems", problems).add("notes", notes);
    report.add("findings", provenance.findings).add("warnings", provenance.warnings);
    io::write_report(fmt::format("{}\n", report.text()));
  } else {
    for (const auto& problem : problems)
      io::write_message(fmt::format("{}{}\n", problem.starts_with(file) ? "" : file + ": ", problem));
    if (command.style == ReportStyle::Text) {
      const auto list = [&](const char* kind, const std::vector<std::string>& texts) {
        for (const auto& text : texts) io::write_report(fmt::format("{}: {}: {}\n", file, kind, text));
      };
      list("note", notes);
      list("finding", provenance.findings);
      list("warning", provenance.warnings);
      if (problems.empty()) io::write_report(fmt::format("{}: sound\n", file));
    }
  }
  return problems.empty() ? io::exit_done : io::exit_format;
}

} // namespace iga::solve
