// Lowest eigenpairs of K x = ω² M x by shift-invert Lanczos, with every multiplicity, checked.
#pragma once

#include "solver/analysis/eigen_settings.hpp"
#include "solver/mechanics/mass_operator.hpp"

#include <string>
#include <utility>

namespace iga::io {
class Progress;
}

namespace iga::solve {

struct EigenProblem {
  const StiffnessMatrix* stiffness = nullptr;
  const MassOperator* mass = nullptr;
  const ConstraintMatrix* constraints = nullptr; ///< C x = 0; may be null
  Eigen::MatrixXd motions;                       ///< candidates for rigid modes (rigid_motions); may have no columns
  Eigen::MatrixXd known; ///< eigenvectors of an earlier run, if any: they are checked and completed, not searched for
  io::Progress* progress = nullptr; ///< where stages show themselves; may be null
  double lambda_scale = 1;          ///< ω² of the size of the part's first elastic ones: (π c_S / L)²
};

enum class ModeKind {
  Rigid,     ///< a rigid motion of a body, written down and checked
  Mechanism, ///< a motion without stiffness that is not rigid: parts that are connected by too little material
  Elastic,
};

/// Proof that no mode below `shift` is missing: the number of negative eigenvalues of K - shift M.
struct SturmCount {
  double shift = 0;          ///< ω², in a gap of the spectrum
  std::int64_t expected = 0; ///< eigenvalues below it, by inertia
  std::int64_t found = 0;    ///< by Lanczos
};

struct ModeSet {
  Eigen::VectorXd lambda;     ///< (modes): ω², ascending within rigid modes, mechanisms, elastic modes
  std::vector<ModeKind> kind; ///< (modes)
  Eigen::VectorXd residual; ///< (modes): ‖K x - ω² M x‖ / (ω² ‖M x‖); ω² of the first elastic mode below it
  Eigen::MatrixXd vectors; ///< (num_unknowns × modes), xᵀ M x = 1, component of largest magnitude positive
  std::int64_t rigid = 0, mechanisms = 0, elastic = 0;
  std::optional<SturmCount> sturm;
  bool searched_again = false; ///< without a Sturm count: a second search beside the modes found looked for missed ones
  std::vector<std::string> warnings;
  FactorCost factor;
  std::int64_t solves = 0;                             ///< right-hand sides
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// Largest residual that an eigenpair may have.
constexpr double residual_limit = 1e-8;

/// The rigid modes, mechanisms and `settings.modes` elastic modes of lowest frequency, or all below a frequency: where
/// a Sturm count is made, it says at first how many these are; else more are searched for until one lies above.
/// @throws InputError for more modes than unknowns or most_modes_below, or where the factor will not fit into memory
/// @throws NumericalError where a residual stays above residual_limit, or modes stay missing
ModeSet lowest_modes(const EigenProblem& problem, const EigenSettings& settings);

} // namespace iga::solve
