#include "solver/explicit/run/run_parts.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/laws/curve.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

void refuse(const io::SettingsTable& table, std::string_view key, const std::string& why) {
  throw InputError(fmt::format("{}: {}", table.where(key), why));
}

std::string place_of(const io::SettingsTable& table, std::string_view key) {
  const std::string where = table.where(key);
  return where.substr(0, where.rfind(": "));
}

std::optional<Point3> read_vector(io::SettingsTable& table, const char* key) {
  const auto v = table.numbers(key, {3});
  return v ? std::optional(Point3{(*v)[0], (*v)[1], (*v)[2]}) : std::nullopt;
}

double need_number(io::SettingsTable& table, const char* key, const char* what) {
  const auto value = table.number(key);
  if (!value) refuse(table, key, fmt::format("missing; give {}", what));
  return *value;
}

Point3 need_vector(io::SettingsTable& table, const char* key, const char* what) {
  const auto v = read_vector(table, key);
  if (!v) refuse(table, key, fmt::format("missing; give {} as three numbers", what));
  return *v;
}

double number_from(io::SettingsTable& table, const char* key, double otherwise, double least, bool open) {
  const double value = table.number(key).value_or(otherwise);
  if (!(open ? value > least : value >= least))
    refuse(table, key,
           fmt::format("found {:g}, expected a number {} {:g}", value, open ? "above" : "of at least", least));
  return value;
}

Point3 unit_vector(const io::SettingsTable& table, const char* key, const Point3& v) {
  if (!(norm(v) > 0)) refuse(table, key, "the direction has no length");
  return times(v, 1 / norm(v));
}

std::size_t choose(const io::SettingsTable& table, const char* key, const std::string& word,
                   std::span<const std::string> known) {
  const auto found = std::find(known.begin(), known.end(), word);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  const auto near = io::nearest_name(word, {known.begin(), known.end()});
  refuse(table, key,
         fmt::format("found \"{}\", expected one of {}{}", word, fmt::join(known, ", "),
                     near ? fmt::format("; did you mean {}?", *near) : ""));
}

std::string read_name(io::SettingsTable& table, const char* key, const std::string& otherwise) {
  const std::string name = table.text(key).value_or(otherwise);
  if (name.empty() || name.front() == '.' || name.find_first_of("/\n\t") != std::string::npos)
    refuse(table, key,
           fmt::format("found \"{}\", expected a name without slashes that does not begin with a dot", name));
  return name;
}

std::optional<TimeCurve> read_curve(io::SettingsTable& table, const char* key, bool smooth,
                                    std::vector<RunInput>& files) {
  const auto between = smooth ? TimeCurve::Between::Smooth : TimeCurve::Between::Linear;
  if (table.holds_text(key)) {
    const auto file = *table.path(key);
    files.push_back({file, table.where(key)});
    try {
      const Curve curve = Curve::read_csv(file);
      return TimeCurve(curve.x(), curve.y(), between, file.string());
    } catch (const InputError& error) {
      refuse(table, key, error.what());
    }
  }
  if (table.holds_number(key)) return TimeCurve(*table.number(key));
  const auto rows = table.rows(key, 2);
  if (!rows) return std::nullopt;
  std::vector<double> times, values;
  for (const auto& row : *rows) {
    times.push_back(row[0]);
    values.push_back(row[1]);
  }
  return TimeCurve(std::move(times), std::move(values), between, table.where(key));
}

DriveCurves read_drive(io::SettingsTable& table, bool may_turn, std::vector<RunInput>& files) {
  io::SettingsTable drive = table.table("drive");
  const std::array<std::string, 2> kinds{"displacement", "velocity"};
  DriveCurves curves;
  curves.are_velocities = choose(drive, "kind", drive.text("kind").value_or(kinds[0]), kinds) == 1;
  const bool smooth = drive.boolean("smooth").value_or(false);
  const std::array<const char*, 3> axes{"x", "y", "z"};
  for (std::size_t d = 0; d < 3; ++d) curves.along[d] = read_curve(drive, axes[d], smooth, files);
  if (!may_turn) return curves;
  curves.rotation = read_curve(drive, "rotation", smooth, files);
  if (const auto axis = read_vector(drive, "axis")) curves.axis = unit_vector(drive, "axis", *axis);
  return curves;
}

std::size_t body_by_name(io::SettingsTable& table, const char* key, const ExplicitRun& run) {
  const auto name = table.text(key);
  if (!name && run.bodies.size() == 1) return 0;
  if (!name) refuse(table, key, "missing; there are several bodies, name the one that is meant");
  std::vector<std::string> known;
  for (const BodyRun& body : run.bodies) known.push_back(body.body.name);
  return choose(table, key, *name, known);
}

} // namespace iga::solve
