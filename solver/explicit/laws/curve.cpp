#include "solver/explicit/laws/curve.hpp"

#include "format/model/errors.hpp"
#include "solver/base/number_curve.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

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
  TwoColumns columns = read_two_columns(file);
  return {std::move(columns.x), std::move(columns.y), file.string()};
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
