// Symmetric indefinite systems by the multifrontal solver MUMPS: Amestoy, Duff, Koster, L'Excellent (2001).
#include "format/model/errors.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/linalg/free_memory.hpp"
#include "solver/linalg/low_rank.hpp"
#include "solver/linalg/node_ordering.hpp"
#include "solver/linalg/system_columns.hpp"

#include <dmumps_c.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

constexpr int job_start = -1, job_end = -2, job_analyse = 1, job_factorise = 2, job_solve = 3;
constexpr MUMPS_INT world = -987654; ///< MUMPS's name for "all processes", also where there is just one

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

/// The scaled, bordered system by entries, and its elimination order.
struct Entries {
  std::vector<MUMPS_INT> rows, columns; ///< from 1, lower triangle
  std::vector<double> values;
  std::vector<MUMPS_INT> position; ///< (size): place of each unknown in the elimination, from 1
  Eigen::VectorXd scale;           ///< (size)
};

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

Entries make_entries(const SystemMatrix& system, const Border& border) {
  const RowMatrix& C = border.rows;
  SystemColumns columns = scaled_columns(system);
  const std::int64_t n = columns.size(), m = C.rows();
  for (std::int64_t j = 0; j < n && system.added > 0; ++j) // the diagonal comes first in its column
    columns.values[static_cast<std::size_t>(columns.offsets[static_cast<std::size_t>(j)])] += system.added;
  if (n + m > std::numeric_limits<MUMPS_INT>::max())
    throw InputError(fmt::format("{} unknowns are more than MUMPS can number; use larger spans", n + m));
  Entries e;
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

class MumpsSolver final : public LinearSolver {
 public:
  MumpsSolver(const SystemMatrix& system, bool keep_factor) : MumpsSolver(system, make_border(system), keep_factor) {}
  MumpsSolver(const SystemMatrix& system, const Border& border, bool keep_factor)
      : entries_(make_entries(system, border)), size_(system.stiffness->size() + border.constraints),
        hidden_negative_(border.negative) {
    follow_run_threads();
    mumps_.comm_fortran = world;
    mumps_.par = 1;
    mumps_.sym = 2;
    call(job_start);
    control(1) = control(2) = control(3) = -1; // no output
    control(4) = 0;
    mumps_.n = static_cast<MUMPS_INT>(all());
    mumps_.nnz = static_cast<MUMPS_INT8>(entries_.values.size());
    mumps_.irn = entries_.rows.data();
    mumps_.jcn = entries_.columns.data();
    mumps_.a = entries_.values.data();
    mumps_.perm_in = entries_.position.data();
    control(6) = 0;  // rows stay in place: the order is given
    control(7) = 1;  // perm_in
    control(8) = 0;  // scaled already
    control(10) = 0; // no refinement
    control(12) = 1; // the order is that of the graph as it is
    control(13) = 1; // the root front sequentially too: its pivots' signs are counted
    control(24) = 1; // null pivots are found
    control(31) = keep_factor ? 0 : 1;
    mumps_.cntl[2] = null_pivot;
    try {
      factorise(system.announce);
    } catch (...) {
      call(job_end);
      throw;
    }
    entries_.rows = entries_.columns = {};
    entries_.values = {};
  }
  ~MumpsSolver() override { call(job_end); }
  MumpsSolver(const MumpsSolver&) = delete;
  MumpsSolver& operator=(const MumpsSolver&) = delete;

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    follow_run_threads();
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(all(), columns);
    y.topRows(size()) =
        entries_.scale.head(size()).asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(b, size(), columns);
    mumps_.rhs = y.data();
    mumps_.nrhs = columns;
    mumps_.lrhs = static_cast<MUMPS_INT>(all());
    call(job_solve);
    if (mumps_.infog[0] < 0) fail();
    Eigen::Map<Eigen::MatrixXd>(x, size(), columns) = entries_.scale.head(size()).asDiagonal() * y.topRows(size());
  }
  std::int64_t size() const override { return size_; }
  FactorCost cost() const override { return cost_; }
  Inertia counts() const {
    Inertia counts;
    counts.negative = mumps_.infog[11] - hidden_negative_;
    counts.zero = mumps_.infog[27];
    counts.positive = size() - counts.negative - counts.zero;
    return counts;
  }

 private:
  std::int64_t all() const { return entries_.scale.size(); } // with the rows of low rank behind those of size()
  MUMPS_INT& control(int number) { return mumps_.icntl[number - 1]; }
  void call(int job) const {
    mumps_.job = job;
    dmumps_c(&mumps_);
  }

  void factorise(const std::function<void(const FactorCost&)>& announce) {
    call(job_analyse);
    if (mumps_.infog[0] < 0) fail();
    cost_.nonzeros = mumps_.infog[19] >= 0 ? mumps_.infog[19] : std::int64_t{-1000000} * mumps_.infog[19];
    cost_.flops = mumps_.rinfog[0];
    // Pivots that are delayed need more than the analysis foresaw.
    for (const MUMPS_INT percent : {20, 60, 200, 800}) {
      control(14) = percent;
      cost_.bytes = 1e6 * static_cast<double>(mumps_.infog[16]) * (1 + 0.01 * (percent - 20));
      require_memory(cost_, size(), free_memory());
      if (announce) announce(cost_);
      call(job_factorise);
      const MUMPS_INT status = mumps_.infog[0];
      if (status >= 0) return;
      if (status != -8 && status != -9 && status != -14 && status != -15) fail();
    }
    fail();
  }

  [[noreturn]] void fail() const {
    const MUMPS_INT status = mumps_.infog[0];
    if (status == -13 || status == -7 || status == -19)
      throw InputError(fmt::format("not enough memory to factorise a system of {} unknowns (about {:.2f} GiB); use "
                                   "larger spans or a lower degree",
                                   size(), cost_.bytes / (1024.0 * 1024 * 1024)));
    throw NumericalError(
        fmt::format("the factorisation of an indefinite system of {} unknowns failed (MUMPS {}, {}); "
                    "supports contradict each other, or functions on slivers are dependent to rounding",
                    size(), status, mumps_.infog[1]));
  }

  Entries entries_;
  std::int64_t size_ = 0, hidden_negative_ = 0;
  mutable DMUMPS_STRUC_C mumps_{};
  FactorCost cost_;
};

} // namespace

std::unique_ptr<LinearSolver> factorise_indefinite(const SystemMatrix& system) {
  return std::make_unique<MumpsSolver>(system, true);
}

Inertia inertia(const SystemMatrix& system) {
  return MumpsSolver(system, false).counts();
}

} // namespace iga::solve
