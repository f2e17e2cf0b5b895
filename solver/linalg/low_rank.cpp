#include "solver/linalg/low_rank.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/free_memory.hpp"

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::MatrixXd;

// (A + Rᵀ R)⁻¹ = A⁻¹ - Z (I + R Z)⁻¹ Zᵀ with Z = A⁻¹ Rᵀ; I + R Z is at least I.
class LowRankSolver final : public LinearSolver {
 public:
  LowRankSolver(std::unique_ptr<LinearSolver> plain, const RowMatrix& rows) : plain_(std::move(plain)), rows_(rows) {
    const double bytes = 8.0 * 2 * static_cast<double>(rows.rows()) * static_cast<double>(size());
    if (bytes > free_memory())
      throw InputError(fmt::format("{} motions of rigid added bodies take {:.2f} GiB with {} unknowns, more than is "
                                   "free; use fewer bodies or larger spans",
                                   rows.rows(), bytes / (1024.0 * 1024 * 1024), size()));
    const MatrixXd right = MatrixXd(rows_).transpose();
    solved_.resize(right.rows(), right.cols());
    for (Eigen::Index k = 0; k < right.cols(); ++k) plain_->solve(right.col(k).data(), solved_.col(k).data(), 1);
    const MatrixXd capacity = rows_ * solved_;
    capacity_.compute(MatrixXd::Identity(rows.rows(), rows.rows()) + 0.5 * (capacity + capacity.transpose()));
  }

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    plain_->solve(b, x, columns);
    Eigen::Map<MatrixXd> X(x, size(), columns);
    const MatrixXd along = rows_ * X;
    X.noalias() -= solved_ * capacity_.solve(along);
  }
  std::int64_t size() const override { return plain_->size(); }
  FactorCost cost() const override { return plain_->cost(); }
  double added_to_diagonal() const override { return plain_->added_to_diagonal(); }

 private:
  std::unique_ptr<LinearSolver> plain_;
  RowMatrix rows_;
  MatrixXd solved_; // Z
  Eigen::LLT<MatrixXd> capacity_;
};

} // namespace

bool holds_without_low_rank(const SystemMatrix& system) {
  const Eigen::VectorXd& weights = system.stiffness->low_rank_weights();
  if (weights.size() == 0) return true;
  const bool shifted = system.shift < 0 && (system.mass || system.lumped_mass);
  return shifted && (weights.array() > 0).all();
}

LowRankRows low_rank_rows(const SystemMatrix& system) {
  const RowMatrix none, &K = system.stiffness->low_rank(),
                        &M = system.mass && system.shift != 0 ? system.mass->low_rank() : none;
  LowRankRows all;
  all.weights.resize(K.rows() + M.rows());
  all.weights.head(K.rows()) = system.stiffness->low_rank_weights();
  all.weights.tail(M.rows()).setConstant(-system.shift);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [matrix, first] : {std::pair{&K, Eigen::Index{0}}, std::pair{&M, K.rows()}})
    for (Eigen::Index row = 0; row < matrix->rows(); ++row)
      for (RowMatrix::InnerIterator it(*matrix, row); it; ++it)
        entries.emplace_back(static_cast<int>(first + row), static_cast<int>(it.col()), it.value());
  all.rows.resize(all.weights.size(), system.stiffness->size());
  all.rows.setFromTriplets(entries.begin(), entries.end());
  return all;
}

std::unique_ptr<LinearSolver> with_low_rank(std::unique_ptr<LinearSolver> plain, const RowMatrix& rows) {
  return rows.rows() == 0 ? std::move(plain) : std::make_unique<LowRankSolver>(std::move(plain), rows);
}

} // namespace iga::solve
