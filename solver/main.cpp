// igasolve: reads the command line, runs one command, turns errors into text and exit codes.
#include "format/model/errors.hpp"
#include "solver/commands.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <functional>

namespace {

using namespace iga;
using namespace iga::solve;

constexpr const char* footer = R"(Examples:
  igasolve info part.h5              what a model file holds
  igasolve info part.h5 --json       the same for scripts
  igasolve check part.h5             everything that is wrong with a model file

Exit codes:
  0  success
  1  a defect of this program
  2  input or usage: a missing file, a bad option, a failed read or write
  3  a model file that breaks its format
  4  a method that did not reach its tolerance)";

/// Adds a command that looks at one model file.
void add_model_command(CLI::App& app, const char* name, const char* what, int (*run)(const ModelCommand&),
                       std::function<int()>& chosen) {
  auto command = std::make_shared<ModelCommand>();
  auto style = std::make_shared<std::pair<bool, bool>>(); // --json, --quiet
  CLI::App* sub = app.add_subcommand(name, what);
  sub->add_option("model", command->model, "model file made by igaprep")->required();
  auto* json = sub->add_flag("--json", style->first, "print one JSON object");
  sub->add_flag("--quiet", style->second, "print nothing but errors")->excludes(json);
  sub->footer(fmt::format("Example:\n  igasolve {} part.h5", name));
  sub->callback([command, style, run, &chosen] {
    command->style = style->first ? ReportStyle::Json : style->second ? ReportStyle::Quiet : ReportStyle::Text;
    chosen = [command, run] { return run(*command); };
  });
}

int report(const char* message, ExitCode code) {
  fmt::print(stderr, "igasolve: {}\n", message);
  return code;
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app("Analyses of trimmed solids made by igaprep.", "igasolve");
  std::function<int()> chosen;
  app.set_version_flag("--version", "igasolve " IGA_VERSION);
  app.require_subcommand(1);
  app.footer(footer);
  add_model_command(app, "info", "Print what a model file holds", run_info, chosen);
  add_model_command(app, "check", "Validate a model file and print what is wrong", run_check, chosen);
  try {
    app.parse(argc, argv);
    return chosen();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? success : bad_input;
  } catch (const InputError& error) {
    return report(error.what(), bad_input);
  } catch (const FormatError& error) {
    return report(error.what(), bad_format);
  } catch (const NumericalError& error) {
    return report(error.what(), no_convergence);
  } catch (const std::exception& error) {
    return report(fmt::format("unexpected: {}", error.what()).c_str(), our_bug);
  }
}
