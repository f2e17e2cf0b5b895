#include "solver/analysis/buckling_solver.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/constrained_solver.hpp"
#include "solver/linalg/lanczos.hpp"
#include "solver/linalg/product_rounding.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Factors closer than this, relatively, count as one multiplet; a count is never made inside one.
constexpr double multiplet = 1e-6;
// Vectors are one step of the operator better than this, factors twice as many digits.
constexpr double lanczos_tolerance = 1e-9;
// Where loads stress the part unevenly there are no end of motions inside single spans whose factors lie close
// together, at strains of the order of 1. No number of restarts tells them apart; those of the part as a whole come
// first.
constexpr int most_restarts = 20;

SystemMatrix system_of(const BucklingProblem& problem, const StiffnessMatrix& A) {
  SystemMatrix system;
  system.stiffness = &A;
  system.constraints = problem.constraints;
  system.announce = show_factorisation(problem.progress);
  return system;
}

} // namespace

struct BucklingSolver::Factor {
  explicit Factor(const BucklingProblem& problem) : solver(system_of(problem, *problem.stiffness)) {}
  ConstrainedSolver solver;
};

// θ = 1/|λ| are the largest eigenvalues of T = ∓K⁻¹ L, which is symmetric in the product of K.
class BucklingSolver::Search {
 public:
  Search(const BucklingProblem& problem, const ConstrainedSolver& solver, Stopwatch& watch, int wanted, LoadSign sign)
      : problem_(problem), solver_(solver), watch_(watch), wanted_(wanted), sign_(sign == LoadSign::Positive ? 1 : -1) {
    if (problem.progress) problem.progress->start(sign_ > 0 ? "iterations" : "iterations (reversed loads)");
  }

  BucklingModes run(bool sturm) {
    find();
    polish();
    if (sturm)
      count();
    else
      search_again();
    report();
    return std::move(modes_);
  }

 private:
  void find() {
    for (int extra = 2;; extra *= 2) {
      const MatrixXd X = lanczos(wanted_ + extra, lanczos_tolerance, 1, false);
      const bool all = X.cols() == wanted_ + extra;
      X_ = X;
      settle();
      watch_.stage("Lanczos");
      if (!all || whole_ > 0) break;
    }
    if (whole_ == 0) whole_ = theta_.size(); // Lanczos found no more
  }

  // K and L restricted to span(X), solved: largest θ first.
  void rayleigh_ritz() {
    KX_ = columns_of(*problem_.stiffness, X_);
    LX_ = columns_of(*problem_.load_stiffness, X_);
    if (X_.cols() == 0) {
      theta_.resize(0);
      return;
    }
    const MatrixXd A = -sign_ * X_.transpose() * LX_, B = X_.transpose() * KX_;
    const SymmetricEigen eigen = symmetric_eigen(0.5 * (A + A.transpose()), 0.5 * (B + B.transpose()));
    const MatrixXd S = eigen.vectors.rowwise().reverse();
    theta_ = eigen.values.reverse();
    X_ = (X_ * S).eval();
    KX_ = (KX_ * S).eval();
    LX_ = (LX_ * S).eval();
  }

  void settle() {
    rayleigh_ritz();
    whole_ = 0;
    for (Index k = wanted_; k < theta_.size() && whole_ == 0; ++k)
      if (theta_[k - 1] - theta_[k] > multiplet * theta_[k - 1]) whole_ = k;
  }

  // Leading eigenvectors of T with θ > 1 / limit, up to the first one that did not converge.
  MatrixXd lanczos(int wanted, double tolerance, std::uint64_t seed, bool beside_found) {
    LanczosProblem lanczos_problem;
    lanczos_problem.size = problem_.stiffness->size();
    MatrixXd locked, K_locked, work;
    if (beside_found) {
      const VectorXd length = X_.cwiseProduct(KX_).colwise().sum().cwiseSqrt().cwiseInverse();
      locked = X_ * length.asDiagonal();
      K_locked = KX_ * length.asDiagonal();
      lanczos_problem.locked = &locked;
      lanczos_problem.B_locked = &K_locked;
    }
    lanczos_problem.B = [&](const double* x, double* f, int columns) {
      Map<MatrixXd>(f, lanczos_problem.size, columns) =
          columns_of(*problem_.stiffness, Map<const MatrixXd>(x, lanczos_problem.size, columns));
    };
    lanczos_problem.FB = [&](const double* x, double* y, int columns) {
      work = -sign_ * columns_of(*problem_.load_stiffness, Map<const MatrixXd>(x, lanczos_problem.size, columns));
      solver_.solve(work.data(), y, columns);
    };
    if (problem_.progress)
      lanczos_problem.progress = [&](int converged, int all) { problem_.progress->update(converged, all); };
    const LanczosResult found = block_lanczos(
        lanczos_problem, {.wanted = wanted, .tolerance = tolerance, .max_restarts = most_restarts, .seed = seed});
    modes_.solves += found.applied;
    Index good = 0;
    while (good < found.theta.size() && found.theta[good] * problem_.limit > 1 &&
           found.estimate[good] <= tolerance * found.theta[good])
      ++good;
    return found.vectors.leftCols(good);
  }

  VectorXd defect(Index k) const {
    const VectorXd r = KX_.col(k) + sign_ / theta_[k] * LX_.col(k);
    return problem_.constraints ? VectorXd(r - solver_.constraint_forces(r)) : r;
  }
  double residual(Index k) const { return defect(k).norm() * theta_[k] / LX_.col(k).norm(); }
  double worst_residual() const {
    double worst = 0;
    for (Index k = 0; k < kept(); ++k) worst = std::max(worst, residual(k));
    return worst;
  }
  Index kept() const { return std::min<Index>(wanted_, whole_); }

  // Steps of inverse iteration with refinement: what Lanczos, which measures by the energy, and the factorisation leave
  // in the stiffest motions.
  void polish() {
    constexpr int most_rounds = 4;
    double worst = worst_residual();
    for (int round = 0; round < most_rounds && worst > 0.1 * residual_limit; ++round) {
      const MatrixXd X = X_, KX = KX_, LX = LX_;
      const VectorXd theta = theta_;
      const int columns = static_cast<int>(X.cols());
      const MatrixXd F = -sign_ * LX;
      MatrixXd Y(X.rows(), X.cols()), correction(X.rows(), X.cols());
      solver_.solve(F.data(), Y.data(), columns);
      const MatrixXd rest = F - columns_of(*problem_.stiffness, Y);
      solver_.solve(rest.data(), correction.data(), columns);
      modes_.solves += 2 * columns;
      X_ = (Y + correction) * theta.cwiseInverse().asDiagonal();
      rayleigh_ritz();
      const double next = worst_residual();
      if (!(next < worst)) {
        X_ = X;
        KX_ = KX;
        LX_ = LX;
        theta_ = theta;
        break;
      }
      if (next > 0.5 * worst) break;
      worst = next;
    }
    watch_.stage("refinement");
  }

  // θ in a gap behind the factors that are kept.
  double gap() const {
    if (theta_.size() == 0) return 1 / problem_.limit;
    if (whole_ < theta_.size()) return 0.5 * (theta_[whole_ - 1] + theta_[whole_]);
    // The next one is not known; a count that meets it says so.
    constexpr double beyond = 1e-3;
    return (1 - beyond) * theta_[whole_ - 1];
  }

  void take_in(const MatrixXd& missed) {
    MatrixXd all(missed.rows(), X_.cols() + missed.cols());
    if (X_.cols() > 0) all.leftCols(X_.cols()) = X_;
    all.rightCols(missed.cols()) = missed;
    X_ = std::move(all);
    settle();
    if (whole_ == 0) whole_ = theta_.size();
    polish();
  }

  void count() {
    constexpr int most_rounds = 4;
    for (int round = 0; round < most_rounds; ++round) {
      show_stage(problem_.progress, "Sturm count");
      const double at = sign_ / gap();
      StiffnessMatrix A(problem_.stiffness->shared_connectivity());
      add_scaled(*problem_.stiffness, 1, A);
      add_scaled(*problem_.load_stiffness, at, A);
      const Inertia counts = inertia(system_of(problem_, A));
      // Each constraint that is not redundant adds a negative eigenvalue.
      const std::int64_t constraints = problem_.constraints ? problem_.constraints->rows() - counts.zero : 0;
      modes_.count = BucklingCount{at, counts.negative - constraints, whole_};
      watch_.stage("Sturm count");
      const std::int64_t missing = modes_.count->expected - modes_.count->found;
      if (missing == 0) return;
      if (missing < 0)
        throw NumericalError(fmt::format("the Sturm count finds {} buckling factors up to {:.6g}, Lanczos {}: one of "
                                         "them is wrong by rounding",
                                         modes_.count->expected, at, modes_.count->found));
      const MatrixXd missed =
          lanczos(static_cast<int>(missing), lanczos_tolerance, static_cast<std::uint64_t>(round) + 2, true);
      if (missed.cols() == 0) break;
      take_in(missed);
      watch_.stage("Lanczos again");
    }
    const BucklingCount last = *modes_.count;
    modes_.count.reset();
    modes_.warnings.push_back(fmt::format(
        "{} buckling factors lie within {:.6g}, {} of them were told apart: the others belong to motions inside single "
        "spans, where stress has a peak; the list may miss some of them",
        last.expected, last.at, last.found));
  }

  // Another start beside the modes found: whatever it finds below them had been missed.
  void search_again() {
    modes_.searched_again = true;
    constexpr int most_rounds = 10;
    for (int round = 0; round < most_rounds && theta_.size() > 0; ++round) {
      const auto seed = static_cast<std::uint64_t>(round) + 100;
      const MatrixXd near = lanczos(1, 1e-2, seed, true); // 1 % are enough to tell
      watch_.stage("second search");
      if (near.cols() == 0) return;
      const VectorXd x = near.col(0);
      const double theta = -sign_ * x.dot(*problem_.load_stiffness * x) / x.dot(*problem_.stiffness * x);
      if (theta < theta_[whole_ - 1]) return;
      const MatrixXd missed = lanczos(1, lanczos_tolerance, seed, true);
      if (missed.cols() == 0) return;
      take_in(missed);
      watch_.stage("Lanczos again");
    }
  }

  void report() {
    const Index n = kept();
    modes_.factor = sign_ * theta_.head(n).cwiseInverse();
    modes_.vectors = X_.leftCols(n);
    modes_.residual.resize(n);
    for (Index k = 0; k < n; ++k) modes_.residual[k] = residual(k);
    for (Index k = 0; k < n; ++k) normalise(modes_.vectors.col(k));
    if (n > 0 && n < whole_)
      modes_.warnings.push_back(
          fmt::format("the last buckling mode belongs to a multiplet; ask for {} factors to have it whole", whole_));
    const double worst = n > 0 ? modes_.residual.maxCoeff() : 0;
    if (worst <= residual_limit) return;
    double rounding = 0;
    const VectorXd diagonal = problem_.stiffness->diagonal();
    for (Index k = 0; k < n; ++k)
      rounding = std::max(rounding, product_rounding(problem_.stiffness->pattern(), diagonal, X_.col(k)) * theta_[k] /
                                        LX_.col(k).norm());
    if (worst > rounding)
      throw NumericalError(
          fmt::format("the residual of a buckling mode is {:.2g}, at most {:g} is allowed: functions on "
                      "slivers are dependent to rounding",
                      worst, residual_limit));
    modes_.warnings.push_back(
        fmt::format("the residual of a buckling mode is {:.2g}: rounding allows no better here, as "
                    "the stiffest motions of the model are far stiffer than its modes (a thin "
                    "part?)",
                    worst));
  }

  static void normalise(Eigen::Ref<VectorXd> x) {
    const Map<const Eigen::Matrix3Xd> coefficients(x.data(), 3, x.size() / 3);
    const VectorXd lengths = coefficients.colwise().norm();
    const double longest = lengths.maxCoeff();
    Index node = 0; // among those that are equal to rounding the first one decides
    while (lengths[node] < longest * (1 - 1e-6)) ++node;
    Index component = 0;
    coefficients.col(node).cwiseAbs().maxCoeff(&component);
    x *= (coefficients(component, node) < 0 ? -1 : 1) / longest;
  }

  const BucklingProblem& problem_;
  const ConstrainedSolver& solver_;
  Stopwatch& watch_;
  int wanted_;
  double sign_;
  MatrixXd X_, KX_, LX_;
  VectorXd theta_;
  Index whole_ = 0; // pairs up to the first gap behind those wanted
  BucklingModes modes_;
};

BucklingSolver::BucklingSolver(const BucklingProblem& problem) : problem_(problem) {
  Stopwatch watch(timings);
  show_stage(problem.progress, "analysis of the matrix");
  factor_ = std::make_unique<Factor>(problem);
  watch.stage("factorisation");
}

BucklingSolver::~BucklingSolver() = default;

FactorCost BucklingSolver::cost() const {
  return factor_->solver.cost();
}

BucklingModes BucklingSolver::lowest(int wanted, LoadSign sign, std::optional<bool> sturm) {
  Stopwatch watch(timings);
  return Search(problem_, factor_->solver, watch, wanted, sign)
      .run(sturm.value_or(problem_.stiffness->size() < sturm_default));
}

} // namespace iga::solve
