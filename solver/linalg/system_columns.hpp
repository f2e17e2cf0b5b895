// The matrix of a system as plain compressed columns, scaled by its diagonal, as the direct solvers want it.
#pragma once

#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

/// Lower triangle of D A D by columns, rows ascending, with D = diag(|K_ii| + |shift| M_ii)^(-1/2) (1 where that is
/// zero): functions that hold little material have tiny rows, and their scale must not decide about pivots.
struct SystemColumns {
  std::vector<std::int64_t> offsets; ///< (size + 1)
  std::vector<std::int64_t> rows;
  std::vector<double> values;
  Eigen::VectorXd scale; ///< (size): D
  std::int64_t size() const { return scale.size(); }
};

/// K - shift M without the constraints.
SystemColumns scaled_columns(const SystemMatrix& system);
/// A mass matrix over the nodes (one component).
SystemColumns scaled_columns(const MassMatrix& mass);

} // namespace iga::solve
