// Lowest eigenpairs of K x = λ M x by locally optimal block preconditioned conjugate gradients: no factorisation, a
// fixed number of vectors.
#pragma once

#include "solver/linalg/lanczos.hpp"

namespace iga::solve {

struct LobpcgProblem {
  std::int64_t size = 0;
  BlockOperator K, M;                        ///< symmetric, M positive definite
  BlockOperator precondition;                ///< ≈ K⁻¹, symmetric and positive definite
  const Eigen::MatrixXd* locked = nullptr;   ///< (size × k): M-orthonormal; what is found is M-orthogonal to them
  const Eigen::MatrixXd* M_locked = nullptr; ///< M times these
  std::function<void(int converged, int wanted)> progress; ///< told after each step; may be empty
};

struct LobpcgSettings {
  int wanted = 1;          ///< lowest pairs that must converge
  int block = 1;           ///< vectors at a time, more than wanted: the last ones converge slowly
  double tolerance = 1e-8; ///< ‖K x - λ M x‖ ≤ tolerance λ ‖M x‖
  int most_steps = 200;
};

struct LobpcgResult {
  Eigen::VectorXd lambda;   ///< (block), ascending
  Eigen::MatrixXd vectors;  ///< (size × same), M-orthonormal
  Eigen::VectorXd residual; ///< ‖K x - λ M x‖ / (λ ‖M x‖)
  bool converged = false;
  int steps = 0;
  std::int64_t applied = 0; ///< vectors that the preconditioner was applied to
};

/// @param start  (size × block or more), linearly independent: its lowest Ritz vectors are the first ones
/// Knyazev (2001); basis kept orthonormal after Hetmaniuk and Lehoucq (2006), Duersch, Shao, Yang, Gu (2018).
/// The same bits for any number of threads if the operators' are.
LobpcgResult lobpcg(const LobpcgProblem& problem, const Eigen::MatrixXd& start, const LobpcgSettings& settings);

} // namespace iga::solve
