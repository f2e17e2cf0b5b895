#include "solver/nonlinear/nonlinear_restart.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr const char* format = "iga-trimmed-solid-nonlinear-restart";
constexpr const char* format_version = "2.0";
constexpr int format_major = 2;

void write_numbers(io::H5Writer& file, const char* path, const std::vector<double>& values) {
  io::write(file, {path, "mixed", "as the program keeps them", "state of the run"}, values);
}

std::vector<double> read_numbers(const io::H5Reader& file, const char* path) {
  auto values = file.dataset<double>(path, {file.shape(path, 1)[0]});
  const auto bad = std::find_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); });
  if (bad != values.end())
    file.refuse(path, fmt::format("number {} is {}, expected a finite one", bad - values.begin(), *bad));
  return values;
}

void write_pairs(io::H5Writer& file, const char* first, const char* second,
                 const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<std::string> a, b;
  for (const auto& [x, y] : pairs) {
    a.push_back(x);
    b.push_back(y);
  }
  file.strings({first, "1", "as in the run file", "what the run belongs to"}, a);
  file.strings({second, "1", "as in the run file", "what the run belongs to"}, b);
}

std::vector<std::pair<std::string, std::string>> read_pairs(const io::H5Reader& file, const char* first,
                                                            const char* second) {
  const auto a = file.strings(first), b = file.strings(second);
  if (a.size() != b.size())
    file.refuse(second, fmt::format("holds {} texts, expected {} as {}", b.size(), a.size(), first));
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) pairs.emplace_back(a[i], b[i]);
  return pairs;
}

} // namespace

std::vector<std::pair<std::string, std::string>> settings_to_keep(const NonlinearRun& run) {
  std::vector<std::pair<std::string, std::string>> kept;
  for (const io::SettingsEntry& entry : run.settings)
    if (!entry.path.starts_with("nonlinear.") && !entry.path.starts_with("results.") && entry.path != "output")
      kept.emplace_back(entry.path, entry.value);
  return kept;
}

void write_restart(const std::filesystem::path& path, const NonlinearRestart& r) {
  io::H5Writer file(path);
  const char* root = io::names::root;
  file.attribute(root, "format", std::string(format));
  file.attribute(root, "format_version", std::string(format_version));
  file.attribute(root, "program_version", r.version);
  file.attribute(root, "rows", r.rows);
  std::vector<std::pair<std::string, std::string>> inputs;
  for (const InputFile& input : r.inputs) inputs.emplace_back(input.name, input.sha256);
  write_pairs(file, "/input_names", "/input_sha256", inputs);
  write_pairs(file, "/setting_paths", "/setting_values", r.settings);
  write_numbers(file, "/numbers", {r.state.factor, r.state.increment, r.state.work, r.state.external});
  write_numbers(file, "/displacement", {r.state.u.data(), r.state.u.data() + r.state.u.size()});
  write_numbers(file, "/history", r.state.points.history);
  write_numbers(file, "/deformation", r.state.points.F_old);
  write_numbers(file, "/contacts", r.state.contacts);
  file.commit();
}

NonlinearRestart read_nonlinear_restart(const std::filesystem::path& path) {
  const io::H5Reader file(path, io::H5Reader::Writer::H5Writer);
  io::expect_format(file, format, format_major, format_version);
  const char* root = io::names::root;
  NonlinearRestart r;
  r.version = file.text(root, "program_version");
  r.rows = file.number<std::int64_t>(root, "rows");
  if (r.rows < 1) file.refuse("/ attribute rows", fmt::format("is {}, expected 1 or more", r.rows));
  for (auto& [name, sum] : read_pairs(file, "/input_names", "/input_sha256")) r.inputs.push_back({name, sum});
  r.settings = read_pairs(file, "/setting_paths", "/setting_values");
  const auto numbers = read_numbers(file, "/numbers");
  if (numbers.size() != 4) file.refuse("/numbers", fmt::format("holds {} numbers, expected 4", numbers.size()));
  r.state.factor = numbers[0];
  r.state.increment = numbers[1];
  r.state.work = numbers[2];
  r.state.external = numbers[3];
  if (!(r.state.factor >= 0 && r.state.factor <= 1 && r.state.increment > 0))
    file.refuse("/numbers",
                fmt::format("load factor {} and step {}, expected 0 … 1 and above 0", numbers[0], numbers[1]));
  const auto u = read_numbers(file, "/displacement");
  r.state.u = Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  r.state.contacts = read_numbers(file, "/contacts");
  r.state.points = {read_numbers(file, "/history"), read_numbers(file, "/deformation"), {}};
  return r;
}

void check_restart(const NonlinearRestart& restart, const NonlinearRestart& now, const std::filesystem::path& path) {
  if (restart.version != now.version)
    throw InputError(fmt::format("{}: was written by igasolve {}, this is {}; go on with the program that began the "
                                 "run, or start anew without --restart",
                                 path.string(), restart.version, now.version));
  for (const auto& before : restart.settings)
    if (std::find(now.settings.begin(), now.settings.end(), before) == now.settings.end())
      throw InputError(fmt::format("{}: {} was {} when the run began, and is not now; a restart may change "
                                   "[nonlinear] and [results], nothing else: put it back, or start anew without "
                                   "--restart",
                                   path.string(), before.first, before.second));
  for (const auto& after : now.settings)
    if (std::find(restart.settings.begin(), restart.settings.end(), after) == restart.settings.end())
      throw InputError(fmt::format("{}: {} = {} was not there when the run began; a restart may change [nonlinear] and "
                                   "[results], nothing else: take it out, or start anew without --restart",
                                   path.string(), after.first, after.second));
  for (std::size_t i = 0; i < now.inputs.size(); ++i)
    if (i >= restart.inputs.size() || now.inputs[i].sha256 != restart.inputs[i].sha256)
      throw InputError(fmt::format("{}: {} changed since the run began; put back the file that it began with, or start "
                                   "anew without --restart",
                                   path.string(), now.inputs[i].name));
}

} // namespace iga::solve
