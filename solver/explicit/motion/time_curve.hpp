// A number over time from a table: load factors, prescribed displacements and velocities.
#pragma once

#include <string>
#include <vector>

namespace iga::solve {

/// Before the first and after the last time the curve keeps its end values.
class TimeCurve {
 public:
  enum class Between {
    Linear, ///< straight lines
    Smooth, ///< s²(3 - 2s) from value to value: no jump of the slope, which is zero at every given time
  };
  /// The same value at all times.
  explicit TimeCurve(double constant);
  /// @param times   strictly ascending, at least one
  /// @param values  as many
  /// @param what    opens messages
  /// @throws InputError for times that do not ascend, missing or infinite numbers
  TimeCurve(std::vector<double> times, std::vector<double> values, Between between, const std::string& what);

  double value(double t) const;
  /// ∫ from the first time (0 for a constant) to t; negative before it.
  double integral(double t) const;

 private:
  std::vector<double> times_, values_, integrals_; ///< integrals_: up to each time
  Between between_ = Between::Linear;
};

} // namespace iga::solve
