#include "solver/linalg/unsymmetric_solver.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/linalg/free_memory.hpp"
#include "solver/linalg/node_ordering.hpp"

#include <dmumps_c.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

constexpr int job_start = -1, job_end = -2, job_analyse = 1, job_factorise = 2, job_solve = 3;
constexpr MUMPS_INT world = -987654; ///< MUMPS's name for "all processes", also where there is just one

class UnsymmetricSolver final : public LinearSolver {
 public:
  UnsymmetricSolver(const StiffnessMatrix& lower, const StiffnessMatrix& upper) {
    fill(lower, upper);
    follow_run_threads();
    mumps_.comm_fortran = world;
    mumps_.par = 1;
    mumps_.sym = 0;
    call(job_start);
    control(1) = control(2) = control(3) = -1; // no output
    control(4) = 0;
    mumps_.n = static_cast<MUMPS_INT>(size());
    mumps_.nnz = static_cast<MUMPS_INT8>(values_.size());
    mumps_.irn = rows_.data();
    mumps_.jcn = columns_.data();
    mumps_.a = values_.data();
    mumps_.perm_in = position_.data();
    control(6) = 0; // rows stay in place: the diagonal is strong
    control(7) = 1; // perm_in
    control(8) = 0; // scaled already
    control(10) = 0;
    try {
      factorise();
    } catch (...) {
      call(job_end);
      throw;
    }
    rows_ = columns_ = {};
    values_ = {};
  }
  ~UnsymmetricSolver() override { call(job_end); }
  UnsymmetricSolver(const UnsymmetricSolver&) = delete;
  UnsymmetricSolver& operator=(const UnsymmetricSolver&) = delete;

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    follow_run_threads();
    Eigen::Map<Eigen::MatrixXd> y(x, size(), columns);
    y = scale_.asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(b, size(), columns);
    mumps_.rhs = x;
    mumps_.nrhs = columns;
    mumps_.lrhs = static_cast<MUMPS_INT>(size());
    call(job_solve);
    if (mumps_.infog[0] < 0) fail();
    y = scale_.asDiagonal() * y;
  }
  std::int64_t size() const override { return scale_.size(); }
  FactorCost cost() const override { return cost_; }

 private:
  MUMPS_INT& control(int number) { return mumps_.icntl[number - 1]; }
  void call(int job) const {
    mumps_.job = job;
    dmumps_c(&mumps_);
  }

  void fill(const StiffnessMatrix& lower, const StiffnessMatrix& upper) {
    const NodePattern& pattern = lower.pattern();
    const std::int64_t n = pattern.num_nodes();
    if (3 * n > std::numeric_limits<MUMPS_INT>::max())
      throw InputError(fmt::format("{} unknowns are more than MUMPS can number; use larger spans", 3 * n));
    const auto L = lower.values(), U = upper.values();
    const auto at = [](std::int64_t i) { return static_cast<std::size_t>(i); };
    scale_ = lower.diagonal().unaryExpr([](double d) { return d != 0 ? 1 / std::sqrt(std::abs(d)) : 1; });
    const auto entry = [&](std::int64_t row, std::int64_t column, double value) {
      rows_.push_back(static_cast<MUMPS_INT>(row + 1));
      columns_.push_back(static_cast<MUMPS_INT>(column + 1));
      values_.push_back(value * scale_[row] * scale_[column]);
    };
    const auto count = at(18 * pattern.num_pairs());
    rows_.reserve(count);
    columns_.reserve(count);
    values_.reserve(count);
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
    position_.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) position_[at(order[k])] = static_cast<MUMPS_INT>(k + 1);
  }

  void factorise() {
    call(job_analyse);
    if (mumps_.infog[0] < 0) fail();
    cost_.nonzeros = mumps_.infog[19] >= 0 ? mumps_.infog[19] : std::int64_t{-1000000} * mumps_.infog[19];
    cost_.flops = mumps_.rinfog[0];
    for (const MUMPS_INT percent : {20, 60, 200, 800}) { // pivots that are delayed need more than was foreseen
      control(14) = percent;
      cost_.bytes = 1e6 * static_cast<double>(mumps_.infog[16]) * (1 + 0.01 * (percent - 20));
      require_memory(cost_, size(), free_memory());
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
      throw InputError(fmt::format("not enough memory to factorise an unsymmetric system of {} unknowns (about {:.2f} "
                                   "GiB); use larger spans or a lower degree",
                                   size(), cost_.bytes / (1024.0 * 1024 * 1024)));
    throw NumericalError(
        fmt::format("the factorisation of an unsymmetric system of {} unknowns failed (MUMPS {}, {}): the tangent is "
                    "singular",
                    size(), status, mumps_.infog[1]));
  }

  std::vector<MUMPS_INT> rows_, columns_; // from 1
  std::vector<double> values_;
  std::vector<MUMPS_INT> position_; // (size): place of each unknown in the elimination, from 1
  Eigen::VectorXd scale_;
  mutable DMUMPS_STRUC_C mumps_{};
  FactorCost cost_;
};

} // namespace

std::unique_ptr<LinearSolver> factorise_unsymmetric(const StiffnessMatrix& lower, const StiffnessMatrix& upper) {
  return std::make_unique<UnsymmetricSolver>(lower, upper);
}

} // namespace iga::solve
