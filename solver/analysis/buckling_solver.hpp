// Lowest factors λ of (K + λ L) x = 0 by inverse Lanczos in the energy's own product, with every multiplicity, checked.
#pragma once

#include "solver/analysis/eigen_solver.hpp"

namespace iga::solve {

struct BucklingProblem {
  const StiffnessMatrix* stiffness = nullptr;      ///< K, positive definite where the constraints hold
  const StiffnessMatrix* load_stiffness = nullptr; ///< L, what the loads at λ = 1 add to it
  const ConstraintMatrix* constraints = nullptr;   ///< C x = 0; may be null
  io::Progress* progress = nullptr;                ///< where stages show themselves; may be null
  /// λ up to which factors mean anything: beyond it the loads' own strains are large (largest_buckling_strain).
  double limit = 1e12;
};

enum class LoadSign { Positive, Negative };

/// Proof that no factor between 0 and `at` is missing: the number of negative eigenvalues of K + at · L.
struct BucklingCount {
  double at = 0;             ///< signed
  std::int64_t expected = 0; ///< factors between 0 and `at`, by inertia
  std::int64_t found = 0;
};

struct BucklingModes {
  Eigen::VectorXd factor;   ///< (modes): λ of one sign, ascending in size
  Eigen::VectorXd residual; ///< (modes): ‖K x + λ L x‖ / ‖λ L x‖ without the forces of constraints
  Eigen::MatrixXd vectors; ///< (num_unknowns × modes); longest coefficient has length 1, its largest component positive
  std::optional<BucklingCount> count;
  bool searched_again = false; ///< without a count: a second search beside the modes found looked for missed ones
  std::vector<std::string> warnings;
  std::int64_t solves = 0; ///< right-hand sides
};

/// Finds factors of one problem, of either sign; the factor of K is made once.
class BucklingSolver {
 public:
  /// The problem's matrices must outlive the solver.
  /// @throws InputError where the factor will not fit into memory
  /// @throws NumericalError where K is not positive definite
  explicit BucklingSolver(const BucklingProblem& problem);
  ~BucklingSolver();
  /// The `wanted` factors of that sign of least size; fewer where there are no more within the limit.
  /// @param sturm  count them: as EigenSettings::sturm
  /// @throws NumericalError where a residual stays above residual_limit, or factors stay missing
  BucklingModes lowest(int wanted, LoadSign sign, std::optional<bool> sturm);
  FactorCost cost() const;
  /// Stage, seconds; of all searches so far.
  std::vector<std::pair<std::string, double>> timings;

 private:
  class Search;
  struct Factor;
  const BucklingProblem& problem_;
  std::unique_ptr<Factor> factor_;
};

} // namespace iga::solve
