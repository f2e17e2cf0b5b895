// igasolve export: a results file or a model as CSV tables.
#include "format/io/json_text.hpp"
#include "format/io/results_io.hpp"
#include "format/io/settings_reader.hpp"
#include "format/io/standard_streams.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/program/commands.hpp"
#include "solver/report/export_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

namespace fs = std::filesystem;

// Where the tables go: every one into a folder, or one of them into a file.
class Target {
 public:
  explicit Target(const ExportCommand& command) : path_(command.output), table_(command.table), force_(command.force) {
    if (path_.empty()) path_ = command.file.parent_path() / fmt::format("{}_csv", command.file.stem().string());
    one_file_ = path_.extension() == ".csv" && !fs::is_directory(path_);
    if (!one_file_ && fs::exists(path_) && !fs::is_directory(path_))
      throw InputError(fmt::format("{}: is a file; -o names a folder for all tables, or a file that ends with .csv for "
                                   "one of them",
                                   path_.string()));
  }

  void write(const CsvTable& table) {
    names_.push_back(table.name());
    if (one_file_ ? !written_.empty() || (table_ && *table_ != table.name()) : table_ && *table_ != table.name())
      return;
    const fs::path file = one_file_ ? path_ : path_ / (table.name() + ".csv");
    if (!one_file_) {
      std::error_code error;
      fs::create_directories(path_, error);
      if (error) throw InputError(fmt::format("{}: the folder cannot be made: {}", path_.string(), error.message()));
    }
    if (!force_ && fs::exists(file))
      throw InputError(fmt::format("{}: exists; choose another name or add --force to replace it", file.string()));
    table.write(file);
    written_.emplace_back(file.string(), table.rows());
  }

  const std::vector<std::pair<std::string, std::size_t>>& written() const { return written_; }
  const std::vector<std::string>& names() const { return names_; }
  bool one_file() const { return one_file_; }

 private:
  fs::path path_;
  std::optional<std::string> table_;
  bool force_, one_file_ = false;
  std::vector<std::string> names_;
  std::vector<std::pair<std::string, std::size_t>> written_;
};

void report(const ExportCommand& command, const Target& target) {
  if (command.style == ReportStyle::Quiet) return;
  if (command.style == ReportStyle::Json) {
    std::vector<io::JsonObject> files;
    for (const auto& [file, rows] : target.written())
      files.push_back(io::JsonObject().add("file", file).add("rows", rows));
    io::write_report(fmt::format("{}\n", io::JsonObject().add("files", files).add("tables", target.names()).text()));
    return;
  }
  for (const auto& [file, rows] : target.written()) io::write_report(fmt::format("{}: {} rows\n", file, rows));
  if (target.one_file() && !command.table && target.names().size() > 1)
    io::write_report(fmt::format("other tables, with --table NAME, or all with -o FOLDER: {}\n",
                                 fmt::join(target.names().begin() + 1, target.names().end(), ", ")));
}

} // namespace

int run_export(const ExportCommand& command) {
  if (!command.csv) throw InputError("igasolve export: no format is chosen; add --csv");
  Target target(command);
  const auto write = [&](const CsvTable& table) { target.write(table); };
  if (io::holds_results(command.file))
    visit_tables(command.file, io::read_results(command.file), write);
  else
    visit_tables(io::read_model(command.file), write);
  if (target.written().empty()) {
    const auto near = command.table ? io::nearest_name(*command.table, target.names()) : std::nullopt;
    throw InputError(fmt::format("{}: holds no table \"{}\"{}; it holds {}", command.file.string(),
                                 command.table.value_or(""), near ? fmt::format("; did you mean {}?", *near) : "",
                                 fmt::join(target.names(), ", ")));
  }
  report(command, target);
  return io::exit_done;
}

} // namespace iga::solve
