// The commands of igasolve: each takes what the user asked for and returns the exit code; errors are thrown.
#pragma once

#include "format/io/run_tool.hpp"
#include "solver/report/analysis_command.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

struct ModelCommand {
  std::filesystem::path model;
  ReportStyle style = ReportStyle::Text;
};

struct CheckCommand : ModelCommand {
  std::filesystem::path results; ///< empty: the model alone
};

struct ExportCommand {
  std::filesystem::path file;       ///< results or model
  std::filesystem::path output;     ///< folder, or a file that ends with .csv; empty: FILE_csv beside the file
  std::optional<std::string> table; ///< this one alone
  bool csv = false, force = false;
  ReportStyle style = ReportStyle::Text;
};

/// Writes tables of a results file or a model as CSV files. @throws InputError, FormatError
int run_export(const ExportCommand& command);

/// Prints what a sound model file holds. @throws InputError, FormatError
int run_info(const ModelCommand& command);

/// Prints every problem of a model file and a table of what was measured; of results whether they belong to the model.
/// exit_format where there are problems. @throws InputError
int run_check(const CheckCommand& command);

/// Runs eigen, timestep or static: reads the model, analyses, writes the results file, prints the report.
/// @throws InputError, FormatError, NumericalError
int run_analysis(const AnalysisCommand& command);

} // namespace iga::solve
