#include "solver/base/run_tables.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

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

} // namespace iga::solve
