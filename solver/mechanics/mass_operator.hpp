// The mass an analysis works with: consistent, lumped, or the higher-order masses whose inverse is cheap.
#pragma once

#include "solver/linalg/linear_solver.hpp"
#include "solver/mechanics/body_system.hpp"
#include "solver/mechanics/mass_type.hpp"

namespace iga::solve {

/// M as an operator on unknowns, with its inverse. For two and three passes the inverse is the truncated Neumann series
/// of the consistent mass M_C about its row sums M_L,
///   M⁻¹ = (I + R) M_L⁻¹  or  (I + R + R²) M_L⁻¹,  R = I - M_L⁻¹ M_C,
/// symmetric, and positive definite while the spectrum of M_L⁻¹ M_C stays below 2 (two passes; always for three).
/// Functions whose lumped mass is zero (their values underflow) have an inverse mass of zero.
class MassOperator {
 public:
  static MassOperator consistent(MassMatrix M);
  /// @throws NumericalError where a lumped mass is negative, which an extension may cause
  static MassOperator lumped(Eigen::VectorXd masses, std::int64_t moved_functions = 0);
  /// @param passes 2 or 3; throws as lumped
  static MassOperator multi_pass(MassMatrix M, int passes);

  std::int64_t size() const { return size_; } ///< unknowns
  int passes() const { return passes_; }      ///< of the inverse: 1 for lumped and consistent
  bool has_low_rank() const { return matrix_ && matrix_->low_rank().rows() > 0; }
  bool is_consistent() const { return masses_.size() == 0; }
  bool is_lumped() const { return !matrix_; }
  /// M_C; null for the lumped mass.
  const MassMatrix* matrix() const { return matrix_ ? &*matrix_ : nullptr; }
  /// M_L; null for the consistent mass. (num_nodes)
  const Eigen::VectorXd* masses() const { return masses_.size() > 0 ? &masses_ : nullptr; }
  /// (num_unknowns): a vector whose entries scale like M^(-1/2) does, 0 for massless functions.
  Eigen::VectorXd inverse_root_scale() const;
  /// Light functions whose mass went to their nearest master (spare_masses).
  std::int64_t moved_functions() const { return moved_; }
  double total() const { return total_; } ///< mass

  /// y = M x for columns stored one after the other. Two and three passes solve with the inverse, to rounding, by a few
  /// steps of conjugate gradients (its spectrum in units of M_L⁻¹ lies in [1, passes]).
  void multiply(const double* x, double* y, int columns) const;
  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const;
  /// y = M⁻¹ x. The consistent mass is factorised on first use.
  void divide(const double* x, double* y, int columns) const;

 private:
  void divide_pattern(const double* x, double* y, int columns) const;
  void series(const Eigen::VectorXd& scaled, Eigen::VectorXd& y) const;
  void multiply_series_inverse(const double* x, double* y) const;

  std::int64_t size_ = 0;
  std::int64_t moved_ = 0;
  int passes_ = 1;
  double total_ = 0;
  std::optional<MassMatrix> matrix_;
  Eigen::VectorXd masses_;         // (num_nodes)
  Eigen::VectorXd root_, inverse_; // (num_unknowns): M_L^(1/2), M_L^(-1/2) (0 for massless functions)
  mutable std::shared_ptr<LinearSolver> factor_;
  mutable Eigen::MatrixXd solved_, capacity_; // of the part of low rank W: M₀⁻¹ Wᵀ, (I + W M₀⁻¹ Wᵀ)⁻¹
};

/// Mass that a run has beside its material's.
struct AddedMassTerms {
  struct Block {
    std::vector<std::int32_t> nodes; ///< ascending, counted from first_node
    std::int32_t first_node = 0;
    Eigen::MatrixXd matrix; ///< ∫ μ N_i N_j
  };
  std::vector<Block> blocks;
  Eigen::VectorXd lumped;      ///< (num_nodes): row sums of all blocks
  std::vector<RowMatrix> rows; ///< W of rigid bodies' Wᵀ W, (rank × num_unknowns)
};

/// Lumped masses that an extension leaves positive. Extrapolation takes mass from a light function's farther masters; a
/// node that would keep no more than a fifth of its own function's mass is spared: light functions that take from it
/// give all their mass to their nearest master instead (the mass alone; total mass and linear momentum stay exact).
struct SparedMasses {
  Eigen::VectorXd masses; ///< (num_nodes)
  std::int64_t moved = 0; ///< light functions treated so
};
SparedMasses spare_masses(const SolutionSpace& space, double density);

/// K X and M X, column by column. (num_unknowns × k)
Eigen::MatrixXd columns_of(const StiffnessMatrix& K, const Eigen::MatrixXd& X);
Eigen::MatrixXd columns_of(const MassOperator& M, const Eigen::MatrixXd& X);

/// The mass of a run.
/// @param added  rigid bodies only with the consistent mass
/// @throws InputError for two passes on an extended space whose M_L⁻¹ M_C reaches 2
MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       const AddedMassTerms& added = {});
/// The same of one body.
MassOperator make_mass(MassType type, const SolutionSpace& space,
                       const std::shared_ptr<const Connectivity>& connectivity, double density);

/// Largest eigenvalue of M_L⁻¹ M_C by Lanczos (from below, to 1e-3): 1 for the plain basis.
double largest_mass_ratio(const MassMatrix& M, const Eigen::VectorXd& masses);

} // namespace iga::solve
