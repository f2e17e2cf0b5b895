// A tangent times a vector, for comparison with differences.
#pragma once

#include "solver/nonlinear/finite_body.hpp"

namespace iga::test {

// A v entry by entry, as the blocks say it.
inline Eigen::VectorXd product(const solve::Tangent& A, const Eigen::VectorXd& v) {
  const solve::NodePattern& pattern = A.lower.pattern();
  const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
  Eigen::VectorXd y = Eigen::VectorXd::Zero(v.size());
  for (std::int64_t j = 0; j < pattern.num_nodes(); ++j) {
    const std::int64_t first = pattern.offsets[at(j)], rows = pattern.offsets[at(j + 1)] - first;
    for (std::int64_t b = 0; b < 3; ++b)
      for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t a = 0; a < 3; ++a) {
          const std::int64_t row = 3 * std::int64_t{pattern.rows[at(first + r)]} + a, column = 3 * j + b;
          const std::size_t k = at(9 * first + 3 * b * rows + 3 * r + a);
          y[row] += A.lower.values()[k] * v[column];
          if (r > 0) y[column] += (A.symmetric ? A.lower : A.upper).values()[k] * v[row];
        }
  }
  return y;
}

} // namespace iga::test
