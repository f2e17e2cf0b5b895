#include "solver/explicit/run/run_restart.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/io/sha256.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <map>
#include <set>
#include <type_traits>

namespace iga::solve {

namespace {

constexpr const char* format = "iga-trimmed-solid-restart";
constexpr const char* format_version = "3.0";
constexpr int format_major = 3;

// Calls visit(number) for each scalar of the state, always in the same order.
template <class State, class Visit> void for_each_number(State& s, Visit&& visit) {
  for (auto* x :
       {&s.progress.time, &s.progress.dt_last, &s.progress.dt_next, &s.progress.kinetic, &s.progress.control.dt,
        &s.progress.control.target, &s.progress.control.least_before, &s.progress.control.least})
    visit(*x);
  visit(s.progress.control.count);
  visit(s.progress.steps);
  for (auto* works : {&s.progress.closed, &s.progress.open})
    for (auto* x : {&works->internal, &works->load, &works->damping, &works->viscous}) visit(*x);
  for (auto* x : {&s.progress.penalty.stored, &s.progress.penalty.friction, &s.progress.penalty.damping,
                  &s.progress.eroded_energy, &s.progress.start_energy, &s.progress.largest_energy})
    visit(*x);
}

template <class Body, class Visit> void for_each_body_number(Body& b, Visit&& visit) {
  for (auto& x : b.momenta) visit(x);
  auto& r = b.report;
  for (auto* x : {&r.step_factor, &r.min_J, &r.viscous_power, &r.eroded_energy}) visit(*x);
  for (auto* x : {&r.step_span, &r.min_J_span, &r.inverted_span}) visit(*x);
  for (auto* x : {&r.inverted, &r.eroded, &b.inverted, &b.eroded}) visit(*x);
}

template <class Limit, class Visit> void for_each_limit_number(Limit& l, Visit&& visit) {
  visit(l.omega);
  visit(l.dt);
  visit(l.by_lanczos);
  visit(l.products);
  visit(l.element_dt);
}

// Long arrays of a body; the last member of each pair is the name of the dataset.
template <class Body, class Visit> void for_each_array(Body& b, Visit&& visit) {
  visit("displacement", b.displacement);
  visit("velocity", b.velocity);
  visit("momentum", b.momentum);
  visit("history", b.points.history);
  visit("deformation", b.points.F_old);
  visit("erosion", b.points.extra);
}

void write_numbers(io::H5Writer& file, const std::string& path, const std::vector<double>& values) {
  io::write(file, {path.c_str(), "mixed", "as the program keeps them", "state of the run"}, values);
}

// Infinite numbers are limits that nothing has reached yet; no state is not-a-number.
std::vector<double> read_numbers(const io::H5Reader& file, const std::string& path) {
  auto values = file.dataset<double>(path.c_str(), {file.shape(path.c_str(), 1)[0]});
  const auto bad = std::find_if(values.begin(), values.end(), [](double x) { return std::isnan(x); });
  if (bad != values.end())
    file.refuse(path, fmt::format("number {} is not-a-number, expected a number", bad - values.begin()));
  return values;
}

std::vector<double> read_finite(const io::H5Reader& file, const std::string& path) {
  auto values = read_numbers(file, path);
  const auto bad = std::find_if(values.begin(), values.end(), [](double x) { return std::isinf(x); });
  if (bad != values.end())
    file.refuse(path, fmt::format("number {} is {}, expected a finite one", bad - values.begin(), *bad));
  return values;
}

// Takes numbers off the front of a list.
class Take {
 public:
  Take(const io::H5Reader& file, std::string path)
      : file_(file), path_(std::move(path)), from_(read_numbers(file_, path_)) {}
  template <class T> void operator()(T& to) {
    if (next_ >= from_.size()) file_.refuse(path_, "holds fewer numbers than expected");
    const double value = from_[next_++];
    // Counts are kept as numbers too; the limits of T as a double are at most one above what T holds.
    if (std::is_integral_v<T> &&
        !(value == std::floor(value) && value >= static_cast<double>(std::numeric_limits<T>::min()) &&
          std::abs(value) < 0x1p53 && value <= static_cast<double>(std::numeric_limits<T>::max())))
      file_.refuse(path_, fmt::format("number {} is {}, expected a count", next_ - 1, value));
    to = static_cast<T>(value);
  }
  void expect_end() const {
    if (next_ != from_.size()) file_.refuse(path_, fmt::format("holds {} numbers, expected {}", from_.size(), next_));
  }

 private:
  const io::H5Reader& file_;
  std::string path_;
  std::vector<double> from_;
  std::size_t next_ = 0;
};

// The groups that a path goes through, but for those that are there.
void make_groups(io::H5Writer& file, const std::string& path, std::set<std::string>& made) {
  for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1))
    if (made.insert(path.substr(0, end)).second) file.group(path.substr(0, end).c_str(), "state of a part of the run");
}

void write_texts(io::H5Writer& file, const char* path, const char* description, const std::vector<std::string>& texts) {
  file.strings({path, "1", "index of the list", description}, texts);
}

// Two lists of the same length.
std::pair<std::vector<std::string>, std::vector<std::string>> read_lists(const io::H5Reader& file, const char* first,
                                                                         const char* second) {
  auto a = file.strings(first), b = file.strings(second);
  if (a.size() != b.size()) file.refuse(second, fmt::format("found {} texts, expected {}", b.size(), a.size()));
  return {std::move(a), std::move(b)};
}

// May this value differ between a run and its restart?
bool may_change(const std::string& path) {
  if (path == "output.subdivide") return false; // the fields before have that mesh
  return path.starts_with("time.") || path.starts_with("output.") || path.starts_with("energy.") ||
         path.starts_with("watch.") || path.starts_with("stop[");
}

struct Change {
  std::string path, before, now;
  unsigned line = 0; ///< 0: not there any more
};

std::vector<Change> changes(const std::vector<RestartState::Setting>& before, const ExplicitRun& run) {
  std::map<std::string, Change> all;
  for (const auto& [path, value] : before) all[path] = {path, value, "nothing", 0};
  const auto settings = settings_to_keep(run);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    Change& change = all.try_emplace(settings[i].path, Change{settings[i].path, "nothing", {}, 0}).first->second;
    change.now = settings[i].value;
    change.line = run.settings[i].line;
  }
  std::vector<Change> found;
  for (auto& [path, change] : all)
    if (change.before != change.now) found.push_back(std::move(change));
  return found;
}

} // namespace

std::vector<RestartState::Setting> settings_to_keep(const ExplicitRun& run) {
  constexpr std::size_t most = 100; // letters that a message can show
  std::vector<RestartState::Setting> kept;
  for (const io::SettingsEntry& entry : run.settings)
    kept.push_back({entry.path, entry.value.size() <= most
                                    ? entry.value
                                    : fmt::format("a value of {} letters (SHA-256 {})", entry.value.size(),
                                                  io::sha256_text(entry.value))});
  return kept;
}

std::filesystem::path restart_path(const std::filesystem::path& results) {
  return results.parent_path() / (results.stem().string() + "_restart.h5");
}

void write_restart(const std::filesystem::path& path, const RestartState& r) {
  io::H5Writer file(path);
  const char* root = io::names::root;
  file.attribute(root, "format", std::string(format));
  file.attribute(root, "format_version", std::string(format_version));
  file.attribute(root, "program_version", r.version);
  std::vector<std::string> names, sums, paths, values, bodies, sources;
  for (const InputFile& input : r.inputs) {
    names.push_back(input.name);
    sums.push_back(input.sha256);
  }
  for (const auto& [key, value] : r.settings) {
    paths.push_back(key);
    values.push_back(value);
  }
  for (const auto& body : r.state.bodies) bodies.push_back(body.name);
  for (const SavedArray& array : r.state.sources) sources.push_back(array.name);
  write_texts(file, "/input_names", "files that the run depends on, the run file first", names);
  write_texts(file, "/input_sha256", "of their contents", sums);
  write_texts(file, "/setting_paths", "keys of the run file", paths);
  write_texts(file, "/setting_values", "their values", values);
  write_texts(file, "/body_names", "bodies in the order of the run", bodies);
  write_texts(file, "/source_names", "datasets of contacts, rigid bodies and supports, in the order of the run",
              sources);
  file.attribute(root, "rows", r.rows);
  file.attribute(root, "fields", r.fields);
  std::vector<double> numbers;
  const auto keep = [&numbers](const auto& x) { numbers.push_back(static_cast<double>(x)); };
  for_each_number(r.state, keep);
  write_numbers(file, "/numbers", numbers);
  write_numbers(file, "/sums", r.sums);
  std::set<std::string> groups;
  for (std::size_t b = 0; b < r.state.bodies.size(); ++b) {
    const std::string group = "/bodies/" + bodies[b] + "/";
    make_groups(file, group, groups);
    numbers.clear();
    for_each_limit_number(r.limits[b], keep);
    for_each_body_number(r.state.bodies[b], keep);
    write_numbers(file, group + "numbers", numbers);
    for_each_array(r.state.bodies[b], [&](const char* name, const std::vector<double>& array) {
      write_numbers(file, group + name, array);
    });
  }
  for (const SavedArray& array : r.state.sources) {
    const std::string dataset = "/" + array.name;
    make_groups(file, dataset, groups);
    write_numbers(file, dataset, array.values);
  }
  file.commit();
}

RestartState read_restart(const std::filesystem::path& path) {
  const io::H5Reader file(path, io::H5Reader::Writer::H5Writer);
  io::expect_format(file, format, format_major, format_version);
  const char* root = io::names::root;
  RestartState r;
  r.version = file.text(root, "program_version");
  const auto [names, sums] = read_lists(file, "/input_names", "/input_sha256");
  for (std::size_t i = 0; i < names.size(); ++i) r.inputs.push_back({names[i], sums[i]});
  const auto [paths, values] = read_lists(file, "/setting_paths", "/setting_values");
  for (std::size_t i = 0; i < paths.size(); ++i) r.settings.push_back({paths[i], values[i]});
  const auto count = [&](const char* name) {
    const auto n = file.number<std::int64_t>(root, name);
    if (n < 0) file.refuse(fmt::format("/ attribute {}", name), fmt::format("is {}, expected 0 or more", n));
    return n;
  };
  r.rows = count("rows");
  r.fields = count("fields");
  Take take(file, "/numbers");
  for_each_number(r.state, take);
  take.expect_end();
  r.sums = read_finite(file, "/sums");
  for (const std::string& name : file.strings("/body_names")) {
    const std::string group = "/bodies/" + name + "/";
    r.limits.emplace_back();
    r.state.bodies.emplace_back();
    r.state.bodies.back().name = name;
    Take own(file, group + "numbers");
    for_each_limit_number(r.limits.back(), own);
    for_each_body_number(r.state.bodies.back(), own);
    own.expect_end();
    for_each_array(r.state.bodies.back(),
                   [&](const char* array, std::vector<double>& to) { to = read_finite(file, group + array); });
  }
  for (const std::string& name : file.strings("/source_names"))
    r.state.sources.push_back({name, read_numbers(file, "/" + name), 0});
  return r;
}

std::vector<std::string> check_restart(const RestartState& restart, const ExplicitRun& run,
                                       const std::vector<InputFile>& inputs, const std::filesystem::path& path,
                                       const std::string& version) {
  if (restart.version != version)
    throw InputError(
        fmt::format("{}: was written by igasolve {}, this is {}; go on with the program that began the run, "
                    "or start anew without --restart",
                    path.string(), restart.version, version));
  std::string told;
  for (const Change& change : changes(restart.settings, run)) {
    const std::string what = fmt::format("{}: {} when the run began, {} now", change.path, change.before, change.now);
    if (!may_change(change.path))
      throw InputError(fmt::format("{}{}: {}; a restart may change [time], [energy], [watch], [[stop]] and [output] "
                                   "without subdivide, nothing else: put it back, or start anew without --restart",
                                   run.file.string(), change.line > 0 ? fmt::format(":{}", change.line) : "", what));
    told += (told.empty() ? "" : "; ") + what;
  }
  std::vector<std::string> bodies, saved;
  for (const auto& body : run.bodies) bodies.push_back(body.body.name);
  for (const auto& body : restart.state.bodies) saved.push_back(body.name);
  if (saved != bodies)
    throw InputError(fmt::format("{}: /body_names: found {}, expected {}; the restart file belongs to another run",
                                 path.string(), fmt::join(saved, ", "), fmt::join(bodies, ", ")));
  if (inputs.size() != restart.inputs.size())
    throw InputError(
        fmt::format("{}: /input_names: found {} files, expected {}; the restart file belongs to another run",
                    path.string(), restart.inputs.size(), inputs.size()));
  for (std::size_t i = 1; i < inputs.size(); ++i) // the run file's values were compared above
    if (inputs[i].sha256 != restart.inputs[i].sha256)
      throw InputError(fmt::format(
          "{}: {} changed since the run began (SHA-256 {}…, now {}…); put back the file that it began with, "
          "or start anew without --restart",
          run.inputs[i - 1].where, inputs[i].name, restart.inputs[i].sha256.substr(0, 12),
          inputs[i].sha256.substr(0, 12)));
  if (told.empty()) return {};
  return {fmt::format("{}: the run goes on with settings as they are now: {}", run.file.string(), told)};
}

} // namespace iga::solve
