#include "solver/explicit/laws/curve.hpp"

#include "format/model/errors.hpp"

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

std::size_t piece_index(const std::vector<double>& x, double at) {
  return static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
}

} // namespace

Curve::Curve(std::vector<double> x, std::vector<double> y, const std::string& name)
    : x_(std::move(x)), y_(std::move(y)) {
  if (x_.empty() || x_.size() != y_.size())
    throw InputError(fmt::format("{}: found {} abscissae and {} values, expected as many of both and at least one",
                                 name, x_.size(), y_.size()));
  for (std::size_t k = 0; k < x_.size(); ++k) {
    if (!std::isfinite(x_[k]) || !std::isfinite(y_[k]))
      throw InputError(fmt::format("{}: point {} ({}, {}) is not finite", name, k + 1, x_[k], y_[k]));
    if (k && !(x_[k] > x_[k - 1]))
      throw InputError(fmt::format("{}: abscissa {:.6g} of point {} does not lie above {:.6g} of the point before it; "
                                   "order the points by strictly ascending abscissa",
                                   name, x_[k], k + 1, x_[k - 1]));
  }
  slope_.resize(x_.size(), 0.0);
  for (std::size_t k = 0; k + 1 < x_.size(); ++k) slope_[k] = (y_[k + 1] - y_[k]) / (x_[k + 1] - x_[k]);
  if (x_.size() > 1) slope_.back() = slope_[x_.size() - 2];
}

Curve Curve::read_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw InputError(fmt::format("{}: the curve cannot be opened; give a text file with two columns", file.string()));
  std::vector<double> x, y;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::vector<double> values = numbers_of(line);
    if (values.empty() && x.empty() && number == 1) continue; // headings
    if (values.size() != 2)
      throw InputError(
          fmt::format("{}:{}: found \"{}\", expected two numbers: abscissa and value", file.string(), number, line));
    x.push_back(values[0]);
    y.push_back(values[1]);
  }
  return {std::move(x), std::move(y), file.string()};
}

double Curve::value(double x) const {
  const std::size_t k = piece_index(x_, x);
  return k ? y_[k - 1] + slope_[k - 1] * (x - x_[k - 1]) : y_[0];
}

double Curve::slope(double x) const {
  const std::size_t k = piece_index(x_, x);
  return k ? slope_[k - 1] : 0;
}

} // namespace iga::solve
