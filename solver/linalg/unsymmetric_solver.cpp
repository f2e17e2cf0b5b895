#include "solver/linalg/unsymmetric_solver.hpp"

#include "solver/linalg/mumps_factor.hpp"
#include "solver/linalg/node_ordering.hpp"

#include <cmath>

namespace iga::solve {

namespace {

// The scaled matrix.
MumpsEntries make_entries(const StiffnessMatrix& lower, const StiffnessMatrix& upper) {
  const NodePattern& pattern = lower.pattern();
  const std::int64_t n = pattern.num_nodes();
  need_mumps_numbers(3 * n);
  const auto L = lower.values(), U = upper.values();
  const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
  MumpsEntries e;
  e.scale = lower.diagonal().unaryExpr([](double d) { return d != 0 ? 1 / std::sqrt(std::abs(d)) : 1; });
  const auto entry = [&](std::int64_t row, std::int64_t column, double value) {
    e.rows.push_back(static_cast<MUMPS_INT>(row + 1));
    e.columns.push_back(static_cast<MUMPS_INT>(column + 1));
    e.values.push_back(value * e.scale[row] * e.scale[column]);
  };
  const auto count = at(18 * pattern.num_pairs());
  e.rows.reserve(count);
  e.columns.reserve(count);
  e.values.reserve(count);
  for (std::int64_t j = 0; j < n; ++j) {
    const std::int64_t first = pattern.offsets[at(j)], rows = pattern.offsets[at(j + 1)] - first;
    for (std::int64_t b = 0; b < 3; ++b)
      for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t a = 0; a < 3; ++a) {
          const std::int64_t row = 3 * std::int64_t{pattern.rows[at(first + r)]} + a, column = 3 * j + b;
          const auto k = at(9 * first + 3 * b * rows + 3 * r + a);
          entry(row, column, L[k]);
          if (r > 0) entry(column, row, U[k]);
        }
  }
  const auto order = expand_order(order_nodes(pattern), 3);
  e.position.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) e.position[at(order[k])] = static_cast<MUMPS_INT>(k + 1);
  return e;
}

class UnsymmetricSolver final : public LinearSolver {
 public:
  UnsymmetricSolver(const StiffnessMatrix& lower, const StiffnessMatrix& upper)
      : factor_(make_entries(lower, upper), MumpsFactor::Kind::Unsymmetric, words, lower.size()) {
    factor_.factorise();
  }

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    const auto scale = factor_.scale().asDiagonal();
    Eigen::Map<Eigen::MatrixXd> y(x, size(), columns);
    y = scale * Eigen::Map<const Eigen::MatrixXd>(b, size(), columns);
    factor_.solve(x, columns);
    y = scale * y;
  }
  std::int64_t size() const override { return factor_.size(); }
  FactorCost cost() const override { return factor_.cost(); }

 private:
  static constexpr MumpsWords words{"an unsymmetric system", "an unsymmetric system", ": the tangent is singular"};

  MumpsFactor factor_;
};

} // namespace

std::unique_ptr<LinearSolver> factorise_unsymmetric(const StiffnessMatrix& lower, const StiffnessMatrix& upper) {
  return std::make_unique<UnsymmetricSolver>(lower, upper);
}

} // namespace iga::solve
