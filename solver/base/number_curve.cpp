#include "solver/base/number_curve.hpp"

#include "format/model/errors.hpp"
#include "solver/base/run_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>

namespace iga::solve {

namespace {

// The numbers of a line; nothing where it holds anything else.
std::vector<double> numbers_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  std::vector<double> numbers;
  const char* at = line.c_str();
  while (true) {
    while (*at == ' ' || *at == '\t' || *at == '\r') ++at;
    if (!*at) return numbers;
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at) return {};
    at = end;
  }
}

void need_ascending(const io::SettingsTable& table, const char* key, const NumberCurve& curve) {
  if (curve.x.empty()) refuse(table, key, "holds no point; give a number, rows [[x, y], …] or a file with two columns");
  for (std::size_t k = 0; k < curve.x.size(); ++k) {
    if (!std::isfinite(curve.x[k]) || !std::isfinite(curve.y[k]))
      refuse(table, key, fmt::format("point {} ({}, {}) is not finite", k + 1, curve.x[k], curve.y[k]));
    if (k > 0 && !(curve.x[k] > curve.x[k - 1]))
      refuse(table, key,
             fmt::format("{:.6g} of point {} does not lie above {:.6g} of the point before it; order the points by "
                         "their first number",
                         curve.x[k], k + 1, curve.x[k - 1]));
  }
}

} // namespace

TwoColumns read_two_columns(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw InputError(fmt::format("{}: the curve cannot be opened; give a text file with two columns", file.string()));
  TwoColumns columns;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::vector<double> values = numbers_of(line);
    if (values.empty() && columns.x.empty() && number == 1) continue; // headings
    if (values.size() != 2)
      throw InputError(
          fmt::format("{}:{}: found \"{}\", expected two numbers: abscissa and value", file.string(), number, line));
    columns.x.push_back(values[0]);
    columns.y.push_back(values[1]);
  }
  return columns;
}

double NumberCurve::linear(double at) const {
  const auto k = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  if (k == 0) return y.front();
  if (k == x.size()) return y.back();
  const double share = (at - x[k - 1]) / (x[k] - x[k - 1]);
  return y[k - 1] + share * (y[k] - y[k - 1]);
}

double NumberCurve::log_log(double at) const {
  if (is_constant()) return y.front();
  if (at < x.front() || at > x.back()) return 0;
  const auto end = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  const std::size_t k = std::clamp<std::size_t>(end, 1, x.size() - 1);
  if (!(y[k - 1] > 0) || !(y[k] > 0)) return 0;
  return y[k - 1] * std::pow(at / x[k - 1], std::log(y[k] / y[k - 1]) / std::log(x[k] / x[k - 1]));
}

std::optional<NumberCurve> read_number_curve(io::SettingsTable& table, const char* key) {
  NumberCurve curve;
  curve.where = table.where(key);
  if (table.holds_text(key)) {
    try {
      TwoColumns columns = read_two_columns(*table.path(key));
      curve.x = std::move(columns.x);
      curve.y = std::move(columns.y);
    } catch (const InputError& error) {
      refuse(table, key, error.what());
    }
  } else if (table.holds_number(key)) {
    curve.x = {0};
    curve.y = {*table.number(key)};
  } else if (const auto rows = table.rows(key, 2)) {
    for (const auto& row : *rows) {
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1]);
    }
  } else {
    return std::nullopt;
  }
  need_ascending(table, key, curve);
  return curve;
}

} // namespace iga::solve
