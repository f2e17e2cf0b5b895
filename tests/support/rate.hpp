// Observed orders of convergence.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace iga::test {

/// Slope of log |error| over log h by least squares; prints the table with the order between neighbours.
inline double print_rates(const std::string& title, const std::vector<double>& h, const std::vector<double>& error) {
  std::printf("%s\n%12s %14s %8s\n", title.c_str(), "h", "error", "order");
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double x = std::log(h[i]), y = std::log(std::abs(error[i]));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
    std::printf("%12.5g %14.5e", h[i], error[i]);
    if (i > 0) std::printf(" %8.3f", std::log(error[i] / error[i - 1]) / std::log(h[i] / h[i - 1]));
    std::printf("\n");
  }
  const auto n = static_cast<double>(h.size());
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  std::printf("%12s %23.3f\n", "fitted", slope);
  return slope;
}

} // namespace iga::test
