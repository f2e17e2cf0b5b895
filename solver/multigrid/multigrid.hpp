// Multigrid on the spline hierarchy: an approximate inverse of a stiffness matrix whose cost grows with the number of
// unknowns, and whose quality depends on it hardly at all.
#pragma once

#include "solver/multigrid/block_rows.hpp"

namespace iga::solve {

struct MultigridSettings {
  int sweeps = 1;                 ///< of Gauss–Seidel before and after each coarser level
  std::int64_t few_nodes = 500;   ///< a level with no more is solved directly
  std::int64_t most_nodes = 2500; ///< of the coarsest level: more are refused
};

/// One V-cycle with symmetric Gauss–Seidel over the nodes' 3 × 3 blocks: z ≈ A⁻¹ r. As an operator it is symmetric and
/// positive definite for A that is, up to the rounding of single precision: fit for conjugate gradients and LOBPCG. Its
/// levels are those of SplineLevel, their matrices Pᵀ A P, the coarsest one is factorised.
class Multigrid {
 public:
  /// @throws InputError where the coarsest level that can be made has more than most_nodes
  /// @param held  cells under supports and ties, by body (spline_hierarchy); may be empty
  Multigrid(const ShiftedStiffness& A, const BodySystem& system, const MultigridSettings& settings = {},
            std::span<const std::vector<std::int64_t>> held = {});
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// z = V-cycle of r; (size × columns), column by column. The same bits for any number of threads.
  void apply(const double* r, double* z, int columns) const;
  std::int64_t size() const;
  /// Nodes of each level, finest first.
  std::vector<std::int64_t> level_nodes() const;
  /// Bytes that it holds.
  double bytes() const;

 private:
  struct Hierarchy;
  std::unique_ptr<Hierarchy> hierarchy_;
};

} // namespace iga::solve
