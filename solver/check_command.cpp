// igasolve check: every problem of a model file, in full.
#include "format/io/json_text.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/commands.hpp"

#include <cstdio>
#include <fmt/format.h>

namespace iga::solve {

int run_check(const ModelCommand& command) {
  std::vector<std::string> problems, notes;
  try {
    const TrimmedModel model = io::load_model(command.model);
    problems = check(model);
    if (model.surface.accepted_leak > 0)
      notes.push_back(
          fmt::format("the surface leaks (accepted: {:.3g} span volumes); its areas and its closedness were not "
                      "checked",
                      model.surface.accepted_leak));
  } catch (const FormatError& error) {
    problems.push_back(error.what());
  }
  const std::string file = command.model.string();
  if (command.style == ReportStyle::Json) {
    io::JsonObject report;
    report.add("file", file).add("sound", problems.empty()).add("problems", problems).add("notes", notes);
    fmt::print("{}\n", report.text());
  } else {
    for (const auto& problem : problems)
      fmt::print(stderr, "{}{}\n", problem.starts_with(file) ? "" : file + ": ", problem);
    if (command.style == ReportStyle::Text) {
      for (const auto& note : notes) fmt::print("{}: note: {}\n", file, note);
      if (problems.empty()) fmt::print("{}: sound\n", file);
    }
  }
  return problems.empty() ? io::exit_done : io::exit_format;
}

} // namespace iga::solve
