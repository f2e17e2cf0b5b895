#include "solver/explicit/run_restart.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <type_traits>

namespace iga::solve {

namespace {

constexpr const char* format = "iga-trimmed-solid-restart";
constexpr const char* format_version = "2.0";
constexpr int format_major = 2;

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

std::vector<double> read_numbers(const io::H5Reader& file, const std::string& path) {
  return file.dataset<double>(path.c_str(), {file.shape(path.c_str(), 1)[0]});
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

std::string body_group(std::size_t b) {
  return fmt::format("/bodies/{}", b);
}

} // namespace

std::filesystem::path restart_path(const std::filesystem::path& results) {
  return results.parent_path() / (results.stem().string() + "_restart.h5");
}

void write_restart(const std::filesystem::path& path, const RestartState& r) {
  io::H5Writer file(path);
  const char* root = io::names::root;
  file.attribute(root, "format", std::string(format));
  file.attribute(root, "format_version", std::string(format_version));
  file.attribute(root, "program_version", r.version);
  std::vector<std::string> names, sums;
  for (const InputFile& input : r.inputs) {
    names.push_back(input.name);
    sums.push_back(input.sha256);
  }
  file.attribute(root, "input_names", names);
  file.attribute(root, "input_sha256", sums);
  for (const auto& [name, value] :
       {std::pair("rows", r.rows), std::pair("fields", r.fields), std::pair("next_row", r.next_row),
        std::pair("next_field", r.next_field), std::pair("next_restart", r.next_restart),
        std::pair("bodies", static_cast<std::int64_t>(r.state.bodies.size())),
        std::pair("penalties", static_cast<std::int64_t>(r.state.penalties.size()))})
    file.attribute(root, name, value);
  std::vector<double> numbers;
  const auto keep = [&numbers](const auto& x) { numbers.push_back(static_cast<double>(x)); };
  for_each_number(r.state, keep);
  write_numbers(file, "/numbers", numbers);
  write_numbers(file, "/sums", r.sums);
  file.group("/bodies", "state of each body");
  for (std::size_t b = 0; b < r.state.bodies.size(); ++b) {
    const std::string group = body_group(b);
    file.group(group.c_str(), "state of one body");
    numbers.clear();
    for_each_limit_number(r.limits[b], keep);
    for_each_body_number(r.state.bodies[b], keep);
    write_numbers(file, group + "/numbers", numbers);
    for_each_array(r.state.bodies[b], [&](const char* name, const std::vector<double>& values) {
      write_numbers(file, fmt::format("{}/{}", group, name), values);
    });
  }
  file.group("/penalties", "state of contacts and supports");
  for (std::size_t p = 0; p < r.state.penalties.size(); ++p)
    write_numbers(file, fmt::format("/penalties/{}", p), r.state.penalties[p]);
  file.commit();
}

RestartState read_restart(const std::filesystem::path& path) {
  const io::H5Reader file(path);
  io::expect_format(file, format, format_major, format_version);
  const char* root = io::names::root;
  RestartState r;
  r.version = file.text(root, "program_version");
  const auto names = file.texts(root, "input_names"), sums = file.texts(root, "input_sha256");
  if (names.size() != sums.size()) file.refuse("/ attribute input_sha256", "has another length than input_names");
  for (std::size_t i = 0; i < names.size(); ++i) r.inputs.push_back({names[i], sums[i]});
  const auto count = [&](const char* name) {
    const auto n = file.number<std::int64_t>(root, name);
    if (n < 0) file.refuse(fmt::format("/ attribute {}", name), fmt::format("is {}, expected 0 or more", n));
    return n;
  };
  r.rows = count("rows");
  r.fields = count("fields");
  r.next_row = count("next_row");
  r.next_field = count("next_field");
  r.next_restart = count("next_restart");
  Take take(file, "/numbers");
  for_each_number(r.state, take);
  take.expect_end();
  r.sums = read_numbers(file, "/sums");
  const auto num_bodies = static_cast<std::size_t>(count("bodies"));
  for (std::size_t b = 0; b < num_bodies; ++b) {
    const std::string group = body_group(b);
    r.limits.emplace_back();
    r.state.bodies.emplace_back();
    Take own(file, group + "/numbers");
    for_each_limit_number(r.limits.back(), own);
    for_each_body_number(r.state.bodies.back(), own);
    own.expect_end();
    for_each_array(r.state.bodies.back(), [&](const char* name, std::vector<double>& values) {
      const std::string place = fmt::format("{}/{}", group, name);
      values = read_numbers(file, place);
      const auto bad = std::find_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); });
      if (bad != values.end())
        file.refuse(place, fmt::format("number {} is {}, expected a finite one", bad - values.begin(), *bad));
    });
  }
  const auto num_penalties = static_cast<std::size_t>(count("penalties"));
  for (std::size_t p = 0; p < num_penalties; ++p)
    r.state.penalties.push_back(read_numbers(file, fmt::format("/penalties/{}", p)));
  return r;
}

std::vector<std::string> check_restart(const RestartState& restart, const std::vector<InputFile>& inputs,
                                       const std::filesystem::path& path, const std::string& version) {
  if (restart.version != version)
    throw InputError(
        fmt::format("{}: was written by igasolve {}, this is {}; go on with the program that began the run, "
                    "or start anew without --restart",
                    path.string(), restart.version, version));
  if (inputs.size() != restart.inputs.size())
    throw InputError(
        fmt::format("{}: the run began with {} files, the run file names {} now; restart with the run file "
                    "that it began with",
                    path.string(), restart.inputs.size(), inputs.size()));
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].sha256 == restart.inputs[i].sha256) continue;
    if (i > 0)
      throw InputError(
          fmt::format("{}: changed since the run began (SHA-256 {}…, now {}…); put back the file that it began "
                      "with, or start anew without --restart",
                      inputs[i].name, restart.inputs[i].sha256.substr(0, 12), inputs[i].sha256.substr(0, 12)));
    warnings.push_back(fmt::format("{} changed since the run began; the run goes on with the settings as they are now",
                                   inputs[i].name));
  }
  return warnings;
}

} // namespace iga::solve
