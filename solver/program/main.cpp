// igasolve: runs one command and turns what went wrong into text and exit code.
#include "format/io/interrupt.hpp"
#include "format/io/run_tool.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/program/command_line.hpp"

namespace {

int run(int argc, const char* const* argv) {
  using namespace iga::solve;
  const std::optional<Command> command = parse_command_line(argc, argv);
  if (!command) return iga::io::exit_done;
  const bool only_reads =
      std::holds_alternative<InfoCommand>(*command) || std::holds_alternative<CheckCommand>(*command);
  if (only_reads) iga::io::unblock_termination();
  if (const auto* info = std::get_if<InfoCommand>(&*command)) return run_info(*info);
  if (const auto* check = std::get_if<CheckCommand>(&*command)) return run_check(*check);
  iga::io::install_signal_handlers();
  if (const auto* tables = std::get_if<ExportCommand>(&*command)) return run_export(*tables);
  if (const auto* run = std::get_if<ExplicitCommand>(&*command)) return run_explicit(*run);
  if (const auto* run = std::get_if<NonlinearCommand>(&*command)) return run_nonlinear(*run);
  return run_analysis(std::get<AnalysisCommand>(*command));
}

// Run before the libraries are initialised.
__attribute__((section(".preinit_array"), used)) void (*const before_libraries)() = iga::io::block_termination;

} // namespace

int main(int argc, char** argv) {
  iga::solve::keep_blas_within_memory(argv);
  return iga::io::run_tool("igasolve", [&] { return run(argc, argv); });
}
