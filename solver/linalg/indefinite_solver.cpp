// Symmetric indefinite systems by MUMPS.
#include "solver/linalg/low_rank.hpp"
#include "solver/linalg/mumps_factor.hpp"
#include "solver/linalg/node_ordering.hpp"
#include "solver/linalg/system_columns.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

// Pivots below this share of the scaled matrix's norm are zero: what rounding leaves of a redundant constraint.
constexpr double null_pivot = 1e-13;

/// Rows below the matrix, their diagonal beside them: constraints, with zeros, then parts of low rank. A + w Rᵀ R is
/// what [A Rᵀ; R -1/w] leaves when its last rows are eliminated.
struct Border {
  RowMatrix rows;
  Eigen::VectorXd diagonal;
  std::int64_t constraints = 0;
  std::int64_t negative = 0; ///< rows that bring a negative eigenvalue of their own, of those behind the constraints
};

Border make_border(const SystemMatrix& system) {
  const std::int64_t n = system.stiffness->size();
  Border border;
  const LowRankRows low_rank = low_rank_rows(system);
  border.constraints = system.constraints ? system.constraints->rows() : 0;
  border.rows.resize(border.constraints + low_rank.rows.rows(), n);
  if (border.constraints > 0) border.rows.topRows(border.constraints) = *system.constraints;
  if (low_rank.rows.rows() > 0) border.rows.bottomRows(low_rank.rows.rows()) = low_rank.rows;
  border.diagonal = Eigen::VectorXd::Zero(border.rows.rows());
  border.diagonal.tail(low_rank.rows.rows()) = -low_rank.weights.cwiseInverse();
  border.negative = (low_rank.weights.array() > 0).count();
  return border;
}

// A row of the border follows the last of its unknowns: a constraint's pivot is zero before one of them is eliminated.
std::vector<MUMPS_INT> positions(const NodePattern& pattern, const RowMatrix& C) {
  const auto order = expand_order(order_nodes(pattern), 3);
  const auto n = static_cast<std::int64_t>(order.size()), m = std::int64_t{C.rows()};
  std::vector<std::int64_t> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    place[static_cast<std::size_t>(order[k])] = static_cast<std::int64_t>(k);
  std::vector<std::pair<std::int64_t, std::int64_t>> keys; // after which place, unknown
  keys.reserve(static_cast<std::size_t>(n + m));
  for (std::int64_t i = 0; i < n; ++i) keys.emplace_back(place[static_cast<std::size_t>(i)], i);
  for (std::int64_t r = 0; r < m; ++r) {
    std::int64_t last = 0;
    for (RowMatrix::InnerIterator it(C, r); it; ++it) last = std::max(last, place[static_cast<std::size_t>(it.col())]);
    keys.emplace_back(last, n + r);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<MUMPS_INT> position(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k)
    position[static_cast<std::size_t>(keys[k].second)] = static_cast<MUMPS_INT>(k + 1);
  return position;
}

// The scaled, bordered system.
MumpsEntries make_entries(const SystemMatrix& system, const Border& border) {
  const RowMatrix& C = border.rows;
  SystemColumns columns = scaled_columns(system);
  const std::int64_t n = columns.size(), m = C.rows();
  for (std::int64_t j = 0; j < n && system.added > 0; ++j) // the diagonal comes first in its column
    columns.values[static_cast<std::size_t>(columns.offsets[static_cast<std::size_t>(j)])] += system.added;
  need_mumps_numbers(n + m);
  MumpsEntries e;
  e.position = positions(system.stiffness->pattern(), C);
  e.scale.resize(n + m);
  e.scale.head(n) = columns.scale;
  const auto extra = static_cast<std::size_t>(C.nonZeros() + m);
  e.rows.reserve(columns.rows.size() + extra);
  e.columns.reserve(columns.rows.size() + extra);
  for (std::int64_t j = 0; j < n; ++j)
    for (auto k = columns.offsets[static_cast<std::size_t>(j)]; k < columns.offsets[static_cast<std::size_t>(j) + 1];
         ++k) {
      e.rows.push_back(static_cast<MUMPS_INT>(columns.rows[static_cast<std::size_t>(k)] + 1));
      e.columns.push_back(static_cast<MUMPS_INT>(j + 1));
    }
  e.values = std::move(columns.values);
  e.values.reserve(e.values.size() + extra);
  for (std::int64_t r = 0; r < m; ++r) {
    double largest = 0;
    for (RowMatrix::InnerIterator it(C, r); it; ++it)
      largest = std::max(largest, std::abs(it.value()) * columns.scale[it.col()]);
    e.scale[n + r] = largest > 0 ? 1 / largest : 1;
    for (RowMatrix::InnerIterator it(C, r); it; ++it) {
      e.rows.push_back(static_cast<MUMPS_INT>(n + r + 1));
      e.columns.push_back(static_cast<MUMPS_INT>(it.col() + 1));
      e.values.push_back(it.value() * columns.scale[it.col()] * e.scale[n + r]);
    }
    if (border.diagonal[r] == 0) continue;
    e.rows.push_back(static_cast<MUMPS_INT>(n + r + 1));
    e.columns.push_back(static_cast<MUMPS_INT>(n + r + 1));
    e.values.push_back(border.diagonal[r] * e.scale[n + r] * e.scale[n + r]);
  }
  return e;
}

class IndefiniteSolver final : public LinearSolver {
 public:
  IndefiniteSolver(const SystemMatrix& system, bool keep_factor)
      : IndefiniteSolver(system, make_border(system), keep_factor) {}
  IndefiniteSolver(const SystemMatrix& system, const Border& border, bool keep_factor)
      : size_(system.stiffness->size() + border.constraints), hidden_negative_(border.negative),
        factor_(make_entries(system, border), MumpsFactor::Kind::Symmetric, words, size_) {
    factor_.control(12) = 1; // the order is that of the graph as it is
    factor_.control(13) = 1; // the root front sequentially too: its pivots' signs are counted
    factor_.control(24) = 1; // null pivots are found
    factor_.control(31) = keep_factor ? 0 : 1;
    factor_.real_control(3) = null_pivot;
    factor_.factorise(system.announce);
  }

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    const auto scale = factor_.scale().head(size()).asDiagonal(); // rows of low rank stand behind these
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(factor_.size(), columns);
    y.topRows(size()) = scale * Eigen::Map<const Eigen::MatrixXd>(b, size(), columns);
    factor_.solve(y.data(), columns);
    Eigen::Map<Eigen::MatrixXd>(x, size(), columns) = scale * y.topRows(size());
  }
  std::int64_t size() const override { return size_; }
  FactorCost cost() const override { return factor_.cost(); }
  Inertia counts() const {
    Inertia counts;
    counts.negative = factor_.info(12) - hidden_negative_;
    counts.zero = factor_.info(28);
    counts.positive = size() - counts.negative - counts.zero;
    return counts;
  }

 private:
  static constexpr MumpsWords words{
      "an indefinite system", "a system",
      "; supports contradict each other, or functions on slivers are dependent to rounding"};

  std::int64_t size_ = 0, hidden_negative_ = 0;
  MumpsFactor factor_;
};

} // namespace

std::unique_ptr<LinearSolver> factorise_indefinite(const SystemMatrix& system) {
  return std::make_unique<IndefiniteSolver>(system, true);
}

Inertia inertia(const SystemMatrix& system) {
  return IndefiniteSolver(system, false).counts();
}

} // namespace iga::solve
