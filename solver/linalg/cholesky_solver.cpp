// Supernodal Cholesky: Chen, Davis, Hager, Rajamanickam, Algorithm 887: CHOLMOD (2008).
#include "format/model/errors.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/linalg/cholmod_common.hpp"
#include "solver/linalg/free_memory.hpp"
#include "solver/linalg/low_rank.hpp"
#include "solver/linalg/node_ordering.hpp"
#include "solver/linalg/system_columns.hpp"

#include <cassert>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// What is added to the unit diagonal of a shifted, scaled system that rounding has made indefinite: functions on
// slivers are nearly dependent, and K - shift M, positive definite in exact arithmetic, may have a negative pivot of
// the size of rounding. The change touches combinations that hold a share of 1e-13 of their parts' energy: of a part
// much thinner than its spans that is its bending, which those who solve win back by refinement.
constexpr double roundings[]{0, 1e-14, 1e-13};

// Ratio of the smallest to the largest pivot of a scaled system without a shift below which it counts as singular: a
// free body leaves pivots of rounding, some of them positive, while those of supported, even slender parts are larger
// by many orders.
constexpr double singular = 1e-13;

class CholeskySolver final : public LinearSolver {
 public:
  CholeskySolver(const SystemColumns& columns, const std::vector<std::int64_t>& order, bool definite_by_nature,
                 const char* advice, const std::function<void(const FactorCost&)>& announce = {})
      : scale_(columns.scale) {
    follow_run_threads();
    cholmod_sparse A =
        lower_triangle(static_cast<std::size_t>(columns.size()), columns.offsets, columns.rows, columns.values.data());
    analyse(A, order);
    require_memory(cost_, size(), free_memory());
    if (announce) announce(cost_);
    factorise(A, definite_by_nature, advice);
  }
  ~CholeskySolver() override {
    cholmod_l_free_dense(&solution_, common_.get());
    cholmod_l_free_dense(&work_, common_.get());
    cholmod_l_free_dense(&small_work_, common_.get());
    cholmod_l_free_factor(&factor_, common_.get());
  }
  CholeskySolver(const CholeskySolver&) = delete;
  CholeskySolver& operator=(const CholeskySolver&) = delete;

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    follow_run_threads();
    scaled_.resize(scale_.size(), columns);
    scaled_.noalias() = scale_.asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(b, scale_.size(), columns);
    cholmod_dense rhs{};
    rhs.nrow = rhs.d = static_cast<std::size_t>(scale_.size());
    rhs.ncol = static_cast<std::size_t>(columns);
    rhs.nzmax = rhs.nrow * rhs.ncol;
    rhs.x = scaled_.data();
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_l_solve2(CHOLMOD_A, factor_, &rhs, nullptr, &solution_, nullptr, &work_, &small_work_, common_.get()))
      throw InputError("not enough memory to solve with the factor of this model");
    const Eigen::Map<const Eigen::MatrixXd> y(static_cast<const double*>(solution_->x), scale_.size(), columns);
    Eigen::Map<Eigen::MatrixXd>(x, scale_.size(), columns).noalias() = scale_.asDiagonal() * y;
  }
  std::int64_t size() const override { return scale_.size(); }
  FactorCost cost() const override { return cost_; }
  double added_to_diagonal() const override { return added_; }

 private:
  void analyse(cholmod_sparse& A, const std::vector<std::int64_t>& order) {
    common_->nmethods = 1;
    common_->method[0].ordering = CHOLMOD_GIVEN;
    common_->supernodal = CHOLMOD_SUPERNODAL;
    std::vector<SuiteSparse_long> permutation(order.begin(), order.end());
    factor_ = cholmod_l_analyze_p(&A, permutation.data(), nullptr, 0, common_.get());
    if (!factor_)
      throw InputError(fmt::format("not enough memory to analyse a system of {} unknowns; use larger spans", size()));
    cost_.nonzeros = static_cast<std::int64_t>(common_->lnz);
    cost_.flops = common_->fl;
    // Numbers and indices of the factor, the update matrix of one supernode, two permuted copies of A.
    cost_.bytes = 8.0 * static_cast<double>(factor_->xsize + factor_->ssize + factor_->maxcsize) +
                  32.0 * static_cast<double>(A.nzmax) + 64.0 * static_cast<double>(A.nrow);
  }

  void factorise(cholmod_sparse& A, bool definite_by_nature, const char* advice) {
    for (const double added : roundings) {
      if (added > 0 && !definite_by_nature) break;
      double beta[2]{added, 0};
      const int done = cholmod_l_factorize_p(&A, beta, nullptr, 0, factor_, common_.get());
      if (!done || common_->status == CHOLMOD_OUT_OF_MEMORY || common_->status == CHOLMOD_TOO_LARGE)
        throw InputError(fmt::format("not enough memory for the factor of {} unknowns ({:.3g} nonzeros); use larger "
                                     "spans or a lower degree",
                                     size(), static_cast<double>(cost_.nonzeros)));
      if (common_->status != CHOLMOD_NOT_POSDEF &&
          (definite_by_nature || cholmod_l_rcond(factor_, common_.get()) > singular)) {
        added_ = added;
        return;
      }
    }
    const auto* permutation = static_cast<const SuiteSparse_long*>(factor_->Perm);
    const auto k = static_cast<std::int64_t>(factor_->minor);
    throw NumericalError(
        k < size() ? fmt::format("the system's matrix is not positive definite (unknown {} of {}): {}", permutation[k],
                                 size(), advice)
                   : fmt::format("the system's matrix is singular to rounding ({} unknowns): {}", size(), advice));
  }

  Eigen::VectorXd scale_;
  mutable CholmodCommon common_;
  cholmod_factor* factor_ = nullptr;
  FactorCost cost_;
  double added_ = 0;
  mutable Eigen::MatrixXd scaled_;
  mutable cholmod_dense *solution_ = nullptr, *work_ = nullptr, *small_work_ = nullptr;
};

} // namespace

std::unique_ptr<LinearSolver> factorise_positive_definite(const SystemMatrix& system) {
  const bool shifted = system.shift < 0 && (system.mass || system.lumped_mass);
  const char* advice =
      shifted
          ? "either functions on slivers are dependent to rounding, or a support's penalty or Nitsche terms make the "
            "stiffness indefinite"
          : "either the supports leave a rigid motion free (support more regions or components), or functions on "
            "slivers are dependent to rounding";
  auto plain = std::make_unique<CholeskySolver>(scaled_columns(system),
                                                expand_order(order_nodes(system.stiffness->pattern()), 3), shifted,
                                                advice, system.announce);
  const LowRankRows low_rank = low_rank_rows(system);
  assert((low_rank.weights.array() > 0).all());
  return with_low_rank(std::move(plain), low_rank.weights.cwiseSqrt().asDiagonal() * low_rank.rows);
}

std::unique_ptr<LinearSolver> factorise_mass(const MassMatrix& mass) {
  return std::make_unique<CholeskySolver>(scaled_columns(mass), order_nodes(mass.pattern()), true,
                                          "the consistent mass of functions on slivers is singular to rounding");
}

} // namespace iga::solve
