#include "solver/analysis/eigen_solver.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/dense_eigen.hpp"
#include "solver/analysis/mode_sign.hpp"
#include "solver/analysis/shift_invert.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/free_memory.hpp"
#include "solver/linalg/lanczos.hpp"
#include "solver/linalg/product_rounding.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/rigid_modes.hpp"

#include <fmt/format.h>
#include <limits>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iga::solve {

namespace {

// Of a product with K, in units of its diagonal times the vector: a few hundred terms a row.
constexpr double rounding_of_products = 32 * std::numeric_limits<double>::epsilon();

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// σ = -0.01 (π c_S / L)²: far below the first elastic mode even of slender parts, where the operator is close to K⁻¹;
// rigid motions, which it amplifies, are kept out of the search.
constexpr double shift_share = 0.01;
// A shift this many times the first eigenvalue costs as many digits of it.
constexpr double far_shift = 1e3;
constexpr int most_shifts = 3;
// Eigenvalues closer than this, relatively, count as one multiplet; a Sturm count is never made inside one.
constexpr double multiplet = 1e-6;
// ω < 1e-4 of the first elastic mode: no stiffness.
constexpr double no_stiffness = 1e-8;
// The same for a rigid motion that is known to be one and that rounding stiffens.
constexpr double rigid_limit = 1e-4;
// ω² / λ_scale of anything that may be a mechanism; a first guess, judged against the first elastic mode afterwards.
constexpr double mechanism_guess = 1e-9;
// More than this share of all modes, and at least so many, come from a dense solver: Lanczos would fill the space.
constexpr Index dense_share = 4, dense_least = 64;
// An eigenvalue of which rounding of K may change this share is no result; of the second one the user is told.
constexpr double doubtful = 1e-2, worth_telling = 1e-6;
// The vectors given back are one step of the operator better than this, the eigenvalues twice as many digits.
constexpr double lanczos_tolerance = 1e-9;

/// Eigenpairs found so far, without the free motions.
struct Pairs {
  VectorXd lambda;
  MatrixXd X, KX, MX;

  /// K and M restricted to span(X), solved: ascending, M-orthonormal.
  void rayleigh_ritz(const EigenProblem& problem) {
    KX = columns_of(*problem.stiffness, X);
    MX = columns_of(*problem.mass, X);
    const MatrixXd K = X.transpose() * KX, M = X.transpose() * MX;
    const auto [values, S] = symmetric_eigen(0.5 * (K + K.transpose()), 0.5 * (M + M.transpose()));
    lambda = values;
    X = (X * S).eval();
    KX = (KX * S).eval();
    MX = (MX * S).eval();
  }
  void append(const MatrixXd& more) {
    MatrixXd all(more.rows(), X.cols() + more.cols());
    if (X.cols() > 0) all.leftCols(X.cols()) = X;
    all.rightCols(more.cols()) = more;
    X = std::move(all);
  }
};

class Search {
 public:
  Search(const EigenProblem& problem, const EigenSettings& settings, ModeSet& set)
      : problem_(problem), settings_(settings), set_(set), modes_(settings.modes),
        shift_(-shift_share * problem.lambda_scale), watch_(set.timings) {
    free_ = free_motions(*problem.stiffness, *problem.mass, problem.constraints, problem.motions, problem.lambda_scale);
    const Index constraints = problem.constraints ? problem.constraints->rows() : 0;
    dimensions_ = std::max<Index>(0, problem.mass->size() - free_.vectors.cols() - constraints);
    if (!settings.modes_below && modes_ > dimensions_)
      throw InputError(fmt::format("{} modes were asked for, but the model has {} unknowns, {} rigid motions and {} "
                                   "constraints; ask for at most {} modes or use smaller spans",
                                   modes_, problem.mass->size(), free_.vectors.cols(), constraints, dimensions_));
    watch_.stage("rigid modes");
    show_stage(problem.progress, "analysis of the matrix");
    inverse_ = std::make_unique<ShiftInvert>(problem_, shift_);
    set_.factor = inverse_->cost();
    watch_.stage("factorisation");
    if (settings.modes_below) modes_ = first_guess_below();
    dense_ = takes_dense();
  }

  void run() {
    find_lowest();
    come_closer();
    if (settings_.modes_below)
      while (!settle_limit()) find_more();
    polish();
    if (counts_modes())
      sturm_check();
    else
      search_again();
    report();
  }

 private:
  bool counts_modes() const {
    return settings_.sturm.value_or(problem_.mass->size() < sturm_default) && problem_.mass->passes() == 1;
  }

  double limit() const { return std::pow(2 * std::numbers::pi * *settings_.modes_below, 2); }

  bool takes_dense() const {
    return !(problem_.constraints && problem_.constraints->rows() > 0) && problem_.mass->passes() == 1 &&
           !problem_.mass->has_low_rank() && problem_.stiffness->low_rank().rows() == 0 && modes_ >= dense_least &&
           dense_share * modes_ > dimensions_ && dense_bytes(problem_.mass->size()) < free_memory();
  }

  // Elastic modes below the frequency asked for, by inertia; where none is made, a number to begin with. What is found
  // has the last word (settle_limit).
  int first_guess_below() {
    constexpr int some = 10;
    std::int64_t count = some;
    if (counts_modes()) {
      show_stage(problem_.progress, "Sturm count");
      count = eigenvalues_below(limit(), inverse_->added_to_diagonal()) - free_.vectors.cols();
      watch_.stage("Sturm count");
      refuse_too_many(count, "");
    }
    return static_cast<int>(std::clamp<std::int64_t>(count, 1, dimensions_));
  }

  void refuse_too_many(std::int64_t count, const char* more) const {
    const double bytes = 8.0 * 3 * static_cast<double>(count) * static_cast<double>(problem_.mass->size());
    if (count <= most_modes_below && bytes < free_memory()) return;
    throw InputError(fmt::format(
        "modes_below = {:g}: {}{} elastic modes lie below this frequency, {}; lower it, or "
        "ask for a number of modes",
        *settings_.modes_below, more, count,
        count > most_modes_below
            ? fmt::format("at most {} are given", most_modes_below)
            : fmt::format("and their vectors take {:.2f} GiB, more than is free", bytes / (1024.0 * 1024 * 1024))));
  }

  // Keeps the pairs below the frequency asked for, the last multiplet whole; false where more have to be found first.
  bool settle_limit() {
    const Index below = (pairs_.lambda.array() < limit()).count();
    if (below == pairs_.lambda.size() && below < dimensions_) return false;
    modes_ = static_cast<int>(std::max<Index>(1, below - mechanisms()));
    whole_ = whole_count();
    if (whole_ > 0) modes_ = static_cast<int>(whole_ - mechanisms());
    return whole_ > 0;
  }

  void find_more() {
    refuse_too_many(std::max<std::int64_t>(modes_, pairs_.lambda.size() - mechanisms()), "at least ");
    modes_ = static_cast<int>(std::min<Index>({2 * Index{modes_}, dimensions_, Index{most_modes_below} + 1}));
    dense_ = takes_dense();
    find_lowest();
  }

  // Modes of a thin part lie far below what its length suggests; seen from the first shift they and the rigid motions
  // are one cluster. From a shift of their own size they stand apart.
  void come_closer() {
    for (int round = 0; round < most_shifts; ++round) {
      const double first = first_elastic_guess();
      if (!(first > 0) || -shift_ <= far_shift * first) return;
      shift_ = -first;
      inverse_ = std::make_unique<ShiftInvert>(problem_, shift_);
      watch_.stage("factorisation");
      find_lowest();
    }
  }

  // By full matrices. A mass that has fewer dimensions than the model has unknowns has fewer modes.
  MatrixXd dense(Index wanted) {
    show_stage(problem_.progress, "dense eigenvalue solver");
    MatrixXd X = dense_modes(problem_, shift_, free_.mass_vectors, static_cast<int>(wanted));
    if (X.cols() < wanted) dimensions_ = X.cols();
    if (modes_ > dimensions_)
      throw InputError(fmt::format("{} modes were asked for, but the quadrature points give the model mass in {} "
                                   "directions only, beside {} rigid motions; ask for at most {} modes",
                                   modes_, dimensions_, free_.vectors.cols(), dimensions_));
    watch_.stage("dense solver");
    return X;
  }

  // Lanczos measures by the mass and does not see what a factorisation leaves in motions of hardly any mass: of a part
  // much thinner than its spans. A step of inverse iteration with refinement sets them right.
  void polish() {
    constexpr int most_rounds = 4;
    double worst = worst_residual();
    for (int round = 0; round < most_rounds && worst > residual_limit && !dense_; ++round) {
      const Pairs before = pairs_;
      MatrixXd X(pairs_.X.rows(), pairs_.X.cols());
      inverse_->apply_refined(pairs_.MX.data(), X.data(), static_cast<int>(X.cols()));
      set_.solves += X.cols();
      X -= free_.vectors * (free_.mass_vectors.transpose() * X);
      pairs_.X = std::move(X);
      pairs_.rayleigh_ritz(problem_);
      const double next = worst_residual();
      if (!(next < worst)) {
        pairs_ = before;
        break;
      }
      if (next > 0.5 * worst) break;
      worst = next;
    }
    watch_.stage("refinement");
  }

  // Of the elastic pairs that are kept, without the forces of constraints.
  double worst_residual() const {
    double worst = 0;
    for (Index k = mechanisms(); k < std::min(whole_, mechanisms() + modes_); ++k) {
      VectorXd defect = pairs_.KX.col(k) - pairs_.lambda[k] * pairs_.MX.col(k);
      if (problem_.constraints) defect -= inverse_->constraint_forces(defect);
      worst = std::max(worst, defect.norm() / (std::abs(pairs_.lambda[k]) * pairs_.MX.col(k).norm()));
    }
    return worst;
  }

  // Eigenpairs of lowest frequency beside the free motions (and beside those found, where asked for).
  MatrixXd lanczos(int wanted, double tolerance, bool beside_found, std::uint64_t seed) {
    wanted = std::min(wanted, static_cast<int>(dimensions_ - (beside_found ? pairs_.X.cols() : 0)));
    LanczosResult found = search(wanted, tolerance, beside_found, seed, Product::Mass);
    if (!found.converged && problem_.mass->passes() == 1)
      found = search(wanted, tolerance, beside_found, seed, Product::Energy);
    if (!found.converged)
      throw NumericalError(fmt::format("Lanczos did not converge to {} modes after {} solutions", wanted, set_.solves));
    return found.vectors;
  }

  // (K - σ M)⁻¹ M is symmetric in the inner product of M and in that of K - σ M. The latter costs a second solution a
  // step, but sees motions of hardly any mass, in which rounding keeps the former from converging: Nour-Omid, Parlett,
  // Ericsson, Jensen (1987), How to implement the spectral transformation.
  enum class Product { Mass, Energy };
  LanczosResult search(int wanted, double tolerance, bool beside_found, std::uint64_t seed, Product product) {
    const auto [locked, B_locked] = locked_motions(beside_found, product);
    LanczosProblem lanczos_problem;
    lanczos_problem.size = problem_.mass->size();
    lanczos_problem.locked = &locked;
    lanczos_problem.B_locked = &B_locked;
    MatrixXd between, work;
    if (product == Product::Mass) {
      lanczos_problem.F = [&](const double* f, double* x, int columns) { inverse_->apply(f, x, columns); };
      lanczos_problem.B = [&](const double* x, double* f, int columns) { problem_.mass->multiply(x, f, columns); };
    } else {
      lanczos_problem.F = [&](const double* f, double* x, int columns) {
        between.resize(lanczos_problem.size, columns);
        work.resize(lanczos_problem.size, columns);
        inverse_->apply_refined(f, between.data(), columns);
        problem_.mass->multiply(between.data(), work.data(), columns);
        inverse_->apply_refined(work.data(), x, columns);
      };
      lanczos_problem.B = [&](const double* x, double* f, int columns) {
        const Eigen::Map<const MatrixXd> X(x, lanczos_problem.size, columns);
        Eigen::Map<MatrixXd>(f, lanczos_problem.size, columns) =
            columns_of(*problem_.stiffness, X) - shift_ * columns_of(*problem_.mass, X);
      };
    }
    if (problem_.progress) {
      problem_.progress->start(beside_found ? "iterations (missing modes)" : "iterations");
      lanczos_problem.progress = [&](int converged, int all) { problem_.progress->update(converged, all); };
    }
    // Where rounding keeps the energy product from converging too, more restarts do not help.
    LanczosResult found = block_lanczos(lanczos_problem, {.wanted = wanted,
                                                          .block = settings_.block,
                                                          .tolerance = tolerance,
                                                          .max_restarts = product == Product::Energy ? 10 : 100,
                                                          .seed = seed});
    set_.solves += found.applied * (product == Product::Energy ? 2 : 1);
    return found;
  }

  // A and the first `count` columns of B; either may be without columns, then its rows do not count.
  MatrixXd side_by_side(const MatrixXd& A, const MatrixXd& B, Index count) const {
    MatrixXd both(problem_.mass->size(), A.cols() + count);
    if (A.cols() > 0) both.leftCols(A.cols()) = A;
    if (count > 0) both.rightCols(count) = B.leftCols(count);
    return both;
  }

  // Free motions and, where asked for, the pairs found, orthonormal in a product B, and B times these.
  std::pair<MatrixXd, MatrixXd> locked_motions(bool beside_found, Product product) const {
    const Index k = free_.vectors.cols(), m = beside_found ? pairs_.X.cols() : 0;
    MatrixXd X = side_by_side(free_.vectors, pairs_.X, m), MX = side_by_side(free_.mass_vectors, pairs_.MX, m);
    if (product == Product::Mass) return {std::move(X), std::move(MX)};
    VectorXd length(k + m); // of an eigenvector in K - σ M
    length << VectorXd::Constant(k, std::sqrt(-shift_)),
        (pairs_.lambda.head(m).array() - shift_).max(0).sqrt().matrix();
    return {X * length.cwiseInverse().asDiagonal(), MX * length.asDiagonal()};
  }

  Index mechanisms() const { return (pairs_.lambda.array() < mechanism_guess * problem_.lambda_scale).count(); }

  // Number of pairs below the first gap of the spectrum behind the modes asked for; 0 where all lie in one multiplet.
  Index whole_count() const {
    for (Index k = mechanisms() + modes_; k < pairs_.lambda.size(); ++k)
      if (gap_after(k - 1)) return k;
    return pairs_.lambda.size() >= dimensions_ ? pairs_.lambda.size() : 0;
  }
  bool gap_after(Index k) const {
    return pairs_.lambda[k + 1] - pairs_.lambda[k] > multiplet * std::abs(pairs_.lambda[k + 1]);
  }

  void find_lowest() {
    if (problem_.known.cols() > 0) {
      pairs_.X = problem_.known;
      pairs_.rayleigh_ritz(problem_);
      whole_ = whole_count();
      if (whole_ > 0) return;
    }
    // A few more than asked for, to see where a multiplet ends.
    Index extra = 3;
    for (;;) {
      const Index wanted = std::min<Index>(dimensions_, modes_ + extra);
      pairs_.X = dense_ ? dense(wanted) : lanczos(static_cast<int>(wanted), lanczos_tolerance, false, 1);
      if (!dense_) watch_.stage("Lanczos");
      pairs_.rayleigh_ritz(problem_);
      whole_ = whole_count();
      if (whole_ > 0) return;
      extra = std::max(2 * extra, mechanisms() + 3);
    }
  }

  // Between the last pair that is kept and the next one.
  double gap() const {
    if (whole_ >= pairs_.lambda.size()) return 2 * std::abs(pairs_.lambda[whole_ - 1]);
    return 0.5 * (pairs_.lambda[whole_ - 1] + pairs_.lambda[whole_]);
  }

  // Takes in pairs that had been missed and settles anew where the modes asked for end.
  void take_in(const MatrixXd& missed) {
    pairs_.append(missed);
    pairs_.rayleigh_ritz(problem_);
    whole_ = whole_count();
    if (settings_.modes_below) settle_limit();
    if (whole_ == 0)
      throw NumericalError(
          "the modes found end inside a multiplet after missed ones were taken in; ask for more modes");
  }

  // By the inertia of K - λ M. @param added  to the unit diagonal of the scaled matrix
  std::int64_t eigenvalues_below(double lambda, double added) const {
    SystemMatrix system;
    system.stiffness = problem_.stiffness;
    if (problem_.mass->is_consistent())
      system.mass = problem_.mass->matrix();
    else
      system.lumped_mass = problem_.mass->masses();
    system.constraints = problem_.constraints;
    system.added = added;
    system.shift = lambda;
    const Inertia counts = inertia(system);
    // Each constraint that is not redundant adds a negative eigenvalue.
    return counts.negative - (problem_.constraints ? problem_.constraints->rows() - counts.zero : 0);
  }

  void sturm_check() {
    const double added = inverse_->added_to_diagonal();
    constexpr int most_rounds = 4;
    for (int round = 0; round < most_rounds; ++round) {
      show_stage(problem_.progress, "Sturm count");
      const double shift = gap();
      set_.sturm = SturmCount{shift, eigenvalues_below(shift, added), free_.vectors.cols() + whole_};
      watch_.stage("Sturm count");
      const std::int64_t missing = set_.sturm->expected - set_.sturm->found;
      if (missing == 0) return;
      if (missing < 0) break;
      take_in(lanczos(static_cast<int>(missing), lanczos_tolerance, true, static_cast<std::uint64_t>(round) + 2));
      watch_.stage("Lanczos again");
    }
    if (!(added > 0))
      throw NumericalError(fmt::format("the Sturm count finds {} eigenvalues below omega² = {:.6g}, Lanczos {}: one of "
                                       "them is wrong by rounding",
                                       set_.sturm->expected, set_.sturm->shift, set_.sturm->found));
    set_.sturm.reset();
    set_.warnings.push_back("rounding keeps the Sturm count from proving that no mode is missing: functions on slivers "
                            "are nearly dependent; a second search looked for missing ones instead");
    search_again();
  }

  // Another start beside the modes found: whatever it finds below them had been missed.
  void search_again() {
    set_.searched_again = true;
    constexpr int most_rounds = 10;
    for (int round = 0; round < most_rounds; ++round) {
      if (pairs_.X.cols() >= dimensions_) return;
      // Its Ritz value comes from above; 1 % are enough to tell.
      Pairs next;
      next.X = lanczos(1, 1e-2, true, static_cast<std::uint64_t>(round) + 100);
      next.rayleigh_ritz(problem_);
      watch_.stage("second search");
      if (next.lambda[0] > pairs_.lambda[whole_ - 1]) return;
      take_in(lanczos(1, lanczos_tolerance, true, static_cast<std::uint64_t>(round) + 100));
      watch_.stage("Lanczos again");
    }
  }

  void report() {
    const Index r = free_.vectors.cols();
    const double first_guess = first_elastic_guess();
    const Index floppy = (pairs_.lambda.head(whole_).array() < no_stiffness * first_guess).count();
    const Index elastic = std::min<Index>(modes_, whole_ - floppy), count = floppy + elastic;
    const double first = pairs_.lambda[floppy];
    set_.rigid = r;
    set_.mechanisms = floppy;
    set_.elastic = elastic;
    set_.lambda.resize(r + count);
    set_.lambda.head(free_.lambda.size()) = free_.lambda;
    set_.lambda.tail(count) = pairs_.lambda.head(count);
    set_.vectors = side_by_side(free_.vectors, pairs_.X, count);
    set_.kind.assign(static_cast<std::size_t>(r), ModeKind::Rigid);
    set_.kind.resize(static_cast<std::size_t>(r + floppy), ModeKind::Mechanism);
    set_.kind.resize(static_cast<std::size_t>(r + count), ModeKind::Elastic);
    residuals(r, first);
    for (Index k = 0; k < r + count; ++k) orient(set_.vectors.col(k));
    if (floppy > 0)
      set_.warnings.push_back(fmt::format("{} modes beside the rigid ones have no stiffness: parts of the model are "
                                          "connected by too little material",
                                          floppy));
    if (settings_.modes_below && first >= limit())
      set_.warnings.push_back(
          fmt::format("no elastic mode lies below {:g}; the first one is given", *settings_.modes_below));
    if (count < whole_)
      set_.warnings.push_back(
          fmt::format("the last mode belongs to a multiplet; --modes {} gives it whole", whole_ - floppy));
    if (r > 0) judge_rigid(first);
  }

  // What is called rigid has ω < 1e-4 of the first elastic mode, or as little as rounding of K leaves of it.
  void judge_rigid(double first) {
    Index worst = 0;
    const double left = free_.lambda.cwiseAbs().maxCoeff(&worst);
    if (left <= no_stiffness * first) return;
    const VectorXd diagonal = problem_.stiffness->diagonal();
    const double rounding = rounding_of_products * diagonal.dot(free_.vectors.col(worst).cwiseAbs2());
    if (left > rounding || left > rigid_limit * first)
      throw NumericalError(fmt::format("a rigid motion has omega² = {:.3g}, the first elastic mode {:.3g}: round-off, "
                                       "rigid modes cannot be identified",
                                       left, first));
    set_.warnings.push_back(fmt::format("rounding leaves the rigid motions an omega² of {:.2g} of the first elastic "
                                        "mode's: the part is very thin for its spans",
                                        left / first));
  }

  double first_elastic_guess() const {
    const Index k = mechanisms();
    return k < pairs_.lambda.size() ? pairs_.lambda[k] : problem_.lambda_scale;
  }

  void residuals(Index rigid, double first_elastic) {
    const MatrixXd KX = columns_of(*problem_.stiffness, set_.vectors), MX = columns_of(*problem_.mass, set_.vectors);
    const VectorXd diagonal = problem_.stiffness->diagonal();
    double rounding = 0; // of K x in the worst pair, by the same measure
    double doubt = 0;    // share of an elastic eigenvalue that rounding may change
    set_.residual.resize(set_.lambda.size());
    for (Index k = 0; k < set_.lambda.size(); ++k) {
      const double scale = std::max(std::abs(set_.lambda[k]), first_elastic);
      VectorXd defect = KX.col(k) - set_.lambda[k] * MX.col(k);
      if (problem_.constraints) defect -= inverse_->constraint_forces(defect);
      set_.residual[k] = defect.norm() / (scale * MX.col(k).norm());
      if (k >= rigid && set_.lambda[k] >= first_elastic)
        doubt = std::max(doubt, rounding_of_products * diagonal.dot(set_.vectors.col(k).cwiseAbs2()) / set_.lambda[k]);
    }
    if (doubt > doubtful)
      throw NumericalError(fmt::format("rounding may change an eigenvalue by {:.1g} of itself: the stiffest motions of "
                                       "the model are too far above its modes",
                                       doubt));
    if (doubt > worth_telling)
      set_.warnings.push_back(fmt::format("rounding may change an omega² by {:.1g} of itself: the stiffest motions of "
                                          "the model are far stiffer than its modes (a part much thinner than its "
                                          "spans)",
                                          doubt));
    const double worst = set_.residual.tail(set_.lambda.size() - rigid).maxCoeff();
    for (Index k = 0; k < set_.lambda.size() && worst > residual_limit; ++k)
      rounding = std::max(rounding, product_rounding(problem_.stiffness->pattern(), diagonal, set_.vectors.col(k)) /
                                        (std::max(std::abs(set_.lambda[k]), first_elastic) * MX.col(k).norm()));
    if (worst > residual_limit && worst <= rounding)
      set_.warnings.push_back(fmt::format("the residual of an eigenpair is {:.2g}: rounding allows no better here, as "
                                          "the stiffest motions of the model are far stiffer than its modes (a thin "
                                          "part?)",
                                          worst));
    else if (worst > residual_limit)
      throw NumericalError(fmt::format("the residual of an eigenpair is {:.2g}, at most {:g} is allowed: functions on "
                                       "slivers cause spurious low modes, or are dependent to rounding",
                                       worst, residual_limit));
  }

  const EigenProblem& problem_;
  const EigenSettings& settings_;
  ModeSet& set_;
  int modes_; // elastic ones to find
  double shift_;
  bool dense_ = false;
  Stopwatch watch_;
  FreeMotions free_;
  Index dimensions_ = 0, whole_ = 0;
  std::unique_ptr<ShiftInvert> inverse_;
  Pairs pairs_;
};

} // namespace

ModeSet lowest_modes(const EigenProblem& problem, const EigenSettings& settings) {
  if (settings.modes_below && !(*settings.modes_below > 0))
    throw InputError(fmt::format("modes_below: found {:g}, expected a frequency above 0", *settings.modes_below));
  if (settings.modes < 1)
    throw InputError(fmt::format("{} modes were asked for; ask for at least one", settings.modes));
  ModeSet set;
  Search(problem, settings, set).run();
  return set;
}

} // namespace iga::solve
