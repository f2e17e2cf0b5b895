// Numbers for people.
#pragma once

#include <cmath>

namespace iga {

/// A positive number to so many significant digits, downwards: what is advised as the largest that will do is never too
/// large. What misses the next digit by rounding alone gets it.
inline double rounded_down(double value, int digits) {
  constexpr double rounding = 1e-12;
  const double unit = std::pow(10, std::floor(std::log10(value)) - digits + 1);
  return std::floor(value / unit * (1 + rounding)) * unit;
}

} // namespace iga
