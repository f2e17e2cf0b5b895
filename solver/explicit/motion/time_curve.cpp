#include "solver/explicit/motion/time_curve.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

TimeCurve::TimeCurve(double constant) : times_{0}, values_{constant}, integrals_{0} {}

TimeCurve::TimeCurve(std::vector<double> times, std::vector<double> values, Between between, const std::string& what)
    : times_(std::move(times)), values_(std::move(values)), between_(between) {
  if (times_.empty() || times_.size() != values_.size())
    throw InputError(fmt::format("{}: {} times and {} values; give as many values as times, at least one", what,
                                 times_.size(), values_.size()));
  for (std::size_t i = 0; i < times_.size(); ++i) {
    if (!std::isfinite(times_[i]) || !std::isfinite(values_[i]))
      throw InputError(
          fmt::format("{}: entry {} is ({}, {}); give finite numbers", what, i + 1, times_[i], values_[i]));
    if (i > 0 && !(times_[i] > times_[i - 1]))
      throw InputError(fmt::format("{}: time {} follows time {}; times must ascend", what, times_[i], times_[i - 1]));
  }
  integrals_ = {0};
  // Both rules have the trapezoid's integral over a whole interval.
  for (std::size_t i = 1; i < times_.size(); ++i)
    integrals_.push_back(integrals_.back() + 0.5 * (times_[i] - times_[i - 1]) * (values_[i] + values_[i - 1]));
}

double TimeCurve::value(double t) const {
  if (t <= times_.front()) return values_.front();
  if (t >= times_.back()) return values_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  const double s = (t - times_[i - 1]) / (times_[i] - times_[i - 1]);
  const double share = between_ == Between::Smooth ? s * s * (3 - 2 * s) : s;
  return values_[i - 1] + share * (values_[i] - values_[i - 1]);
}

double TimeCurve::integral(double t) const {
  if (t <= times_.front()) return (t - times_.front()) * values_.front();
  if (t >= times_.back()) return integrals_.back() + (t - times_.back()) * values_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) - times_.begin());
  const double width = times_[i] - times_[i - 1], s = (t - times_[i - 1]) / width;
  const double share = between_ == Between::Smooth ? s * s * s - 0.5 * s * s * s * s : 0.5 * s * s;
  return integrals_[i - 1] + width * (s * values_[i - 1] + share * (values_[i] - values_[i - 1]));
}

} // namespace iga::solve
