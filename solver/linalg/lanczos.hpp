// Block Lanczos with full reorthogonalisation and thick restart for the largest eigenvalues of F B, both symmetric and
// B positive definite: shift-invert (F = (K - σ M)⁻¹, B = M) and largest frequencies (F = K, B = M⁻¹) alike.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>

namespace iga::solve {

/// y = A x for `columns` vectors stored one after the other.
using BlockOperator = std::function<void(const double* x, double* y, int columns)>;

struct LanczosProblem {
  std::int64_t size = 0;
  BlockOperator F, B;
  BlockOperator FB; ///< x → F B x, where that is cheaper than one after the other; F is not asked for then
  const Eigen::MatrixXd* locked = nullptr;   ///< (size × k): B-orthonormal; what is found is B-orthogonal to them
  const Eigen::MatrixXd* B_locked = nullptr; ///< B times these
  Eigen::VectorXd start_scale;               ///< (size): of the random start vectors; empty: 1
  std::function<void(int converged, int wanted)> progress; ///< told after each step; may be empty
};

struct LanczosSettings {
  int wanted = 1;
  int block = 4;            ///< vectors at a time
  int max_basis = 0;        ///< vectors held before a restart; 0: a multiple of `wanted`
  double tolerance = 1e-10; ///< ‖F B x - θ x‖_B ≤ tolerance θ
  int max_restarts = 100;
  std::uint64_t seed = 1;
};

struct LanczosResult {
  Eigen::VectorXd theta;    ///< (found), descending
  Eigen::MatrixXd vectors;  ///< (size × found), B-normal; one step of the operator smoother than the Ritz vectors
  Eigen::VectorXd estimate; ///< (found): ‖F B x - θ x‖_B
  bool converged = false;
  std::int64_t applied = 0; ///< vectors that F was applied to
};

/// Finds fewer than wanted only where the space has no more dimensions.
/// Golub & Underwood (1977); restart: Wu & Simon (2000); one operator step at the end: Ericsson & Ruhe (1980).
LanczosResult block_lanczos(const LanczosProblem& problem, const LanczosSettings& settings);

} // namespace iga::solve
