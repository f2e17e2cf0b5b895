// igasolve check: every problem of a model file in full and a table of what was measured, the first problem of a
// results file, and whether it belongs to a model.
#include "format/io/json_text.hpp"
#include "format/io/results_io.hpp"
#include "format/io/sha256.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "format/model/model_figures.hpp"
#include "format/model/points_outside.hpp"
#include "solver/program/commands.hpp"
#include "solver/report/results_figures.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

struct Found {
  std::vector<std::string> problems, notes;
  std::vector<CheckFigure> figures;
  Provenance provenance;
};

void check_model(const CheckCommand& command, Found& found) {
  TrimmedModel model = io::load_model(command.model);
  found.problems = check(model);
  if (model.surface.accepted_leak > 0)
    found.notes.push_back(
        fmt::format("the surface leaks (accepted: {:.3g} span volumes); its areas, its closedness and whether "
                    "points lie inside it were not checked",
                    model.surface.accepted_leak));
  if (found.problems.empty()) {
    found.figures = measure(model);
    if (model.surface.accepted_leak == 0) {
      const PointsOutside outside = find_points_outside(model);
      found.figures.push_back({"points outside the surface", static_cast<double>(outside.count), 0});
      if (const std::string text = describe(outside, model); !text.empty()) found.problems.push_back(text);
    }
  } else {
    found.notes.push_back("nothing was measured: mend the problems first");
  }
  if (!command.results.empty() && found.problems.empty()) {
    if (!io::holds_results(command.results))
      throw FormatError(fmt::format("{}: is no results file", command.results.string()));
    const auto rows = measure_results(io::read_results(command.results), model, io::sha256_file(command.model));
    found.figures.insert(found.figures.end(), rows.begin(), rows.end());
  }
  for (const CheckFigure& figure : found.figures)
    if (!figure.passes() && figure.what != "points outside the surface") // told above in more words
      found.problems.push_back(
          fmt::format("{}: found {:.3g}, allowed {:.3g}", figure.what, figure.found, figure.allowed));
  found.provenance = std::move(model.provenance);
}

io::JsonObject json_of(const CheckFigure& figure) {
  io::JsonObject row;
  row.add("what", figure.what).add("found", figure.found).add("allowed", figure.allowed).add("pass", figure.passes());
  return row;
}

} // namespace

int run_check(const CheckCommand& command) {
  Found found;
  auto& [problems, notes, figures, provenance] = found;
  try {
    if (command.results.empty() && io::holds_results(command.model))
      provenance = io::read_results(command.model).header.provenance; // refuses what is wrong
    else
      check_model(command, found);
  } catch (const FormatError& error) {
    problems.push_back(error.what());
  }
  const std::string file = command.model.string();
  if (command.style == ReportStyle::Json) {
    std::vector<io::JsonObject> rows;
    for (const CheckFigure& figure : figures) rows.push_back(json_of(figure));
    io::JsonObject report;
    report.add("file", file).add("sound", problems.empty()).add("problems", problems).add("notes", notes);
    report.add("figures", rows).add("findings", provenance.findings).add("warnings", provenance.warnings);
    io::write_report(fmt::format("{}\n", report.text()));
  } else {
    for (const auto& problem : problems)
      io::write_message(fmt::format("{}{}\n",
                                    problem.starts_with(file) ||
                                            (!command.results.empty() && problem.starts_with(command.results.string()))
                                        ? ""
                                        : file + ": ",
                                    problem));
    if (command.style == ReportStyle::Text) {
      if (!figures.empty()) io::write_report("         found   allowed\n");
      for (const CheckFigure& figure : figures)
        io::write_report(fmt::format("{} {:9.2g} {:9.2g}  {}\n", figure.passes() ? "pass" : "FAIL", figure.found,
                                     figure.allowed, figure.what));
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
