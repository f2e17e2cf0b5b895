#include "solver/linalg/system_columns.hpp"

#include <tbb/parallel_for.h>

#include <cmath>

namespace iga::solve {

namespace {

double inverse_root(double diagonal) {
  return diagonal > 0 ? 1 / std::sqrt(diagonal) : 1;
}

} // namespace

SystemColumns scaled_columns(const SystemMatrix& system) {
  const NodePattern& pattern = system.stiffness->pattern();
  const std::int64_t n = pattern.num_nodes();
  const auto K = system.stiffness->values();
  const auto M = system.mass ? system.mass->values() : std::span<const double>{};
  const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
  const auto mass_at = [&](std::int64_t pair) { return M.empty() ? 0 : M[at(pair)]; };
  const auto lumped_at = [&](std::int64_t node) { return system.lumped_mass ? (*system.lumped_mass)[node] : 0; };

  SystemColumns columns;
  columns.scale.resize(3 * n);
  columns.offsets.resize(at(3 * n + 1));
  // Column b of a node leaves out the b rows above its diagonal.
  for (std::int64_t j = 0; j < n; ++j) {
    const std::int64_t first = pattern.offsets[at(j)], rows = pattern.offsets[at(j + 1)] - first;
    const double mass = std::abs(mass_at(first) + lumped_at(j));
    for (std::int64_t b = 0; b < 3; ++b) {
      columns.offsets[at(3 * j + b)] = 9 * first - 3 * j + 3 * b * rows - (b == 2 ? 1 : 0);
      columns.scale[3 * j + b] =
          inverse_root(std::abs(K[at(9 * first + 3 * b * rows + b)]) + std::abs(system.shift) * mass);
    }
  }
  columns.offsets[at(3 * n)] = 9 * pattern.num_pairs() - 3 * n;
  columns.rows.resize(at(columns.offsets[at(3 * n)]));
  columns.values.resize(columns.rows.size());
  tbb::parallel_for(std::int64_t{0}, n, [&](std::int64_t j) {
    const std::int64_t first = pattern.offsets[at(j)], rows = pattern.offsets[at(j + 1)] - first;
    for (std::int64_t b = 0; b < 3; ++b) {
      std::int64_t to = columns.offsets[at(3 * j + b)];
      for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t a = r == 0 ? b : 0; a < 3; ++a, ++to) {
          const std::int64_t row = 3 * std::int64_t{pattern.rows[at(first + r)]} + a;
          double value = K[at(9 * first + 3 * b * rows + 3 * r + a)];
          if (a == b) value -= system.shift * (mass_at(first + r) + (r == 0 ? lumped_at(j) : 0));
          columns.rows[at(to)] = row;
          columns.values[at(to)] = value * columns.scale[row] * columns.scale[3 * j + b];
        }
    }
  });
  return columns;
}

SystemColumns scaled_columns(const MassMatrix& mass) {
  const NodePattern& pattern = mass.pattern();
  SystemColumns columns;
  columns.offsets = pattern.offsets;
  columns.rows.assign(pattern.rows.begin(), pattern.rows.end());
  columns.values.assign(mass.values().begin(), mass.values().end());
  columns.scale = mass.diagonal().unaryExpr(&inverse_root);
  for (std::int64_t j = 0; j < pattern.num_nodes(); ++j)
    for (auto k = static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j)]);
         k < static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j) + 1]); ++k)
      columns.values[k] *= columns.scale[columns.rows[k]] * columns.scale[j];
  return columns;
}

} // namespace iga::solve
