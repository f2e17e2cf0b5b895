// Which solver an analysis takes: the direct one, whose factor grows faster than the model, or multigrid.
#pragma once

#include "solver/linalg/symmetric_matrix.hpp"

#include <optional>
#include <string>

namespace iga::solve {

enum class SolverKind {
  Auto,      ///< direct for small models and for what multigrid cannot treat, else multigrid
  Direct,    ///< factorisation
  Multigrid, ///< conjugate gradients or LOBPCG with multigrid on the spline hierarchy
};

/// @throws InputError for another word than auto, direct, multigrid
SolverKind solver_kind(const std::string& word);

/// What became of the choice, for the report.
struct SolverReport {
  bool multigrid = false;
  std::string reason;                         ///< why this solver
  double factor_estimate = 0;                 ///< bytes that the direct solver's factor would take
  std::vector<std::int64_t> level_nodes = {}; ///< multigrid: nodes of each level, finest first
  int steps = 0;                              ///< multigrid: of the longest solution, or of the search for modes
};
/// "multigrid (…): 5 levels of 52596 … 154 nodes, 28 steps", "direct (…)".
std::string text_of(const SolverReport& report);

/// From this number of unknowns on `auto` takes multigrid: there it is faster and takes a fraction of the memory
/// (README.md); below, the direct solver also proves that no mode is missing.
constexpr std::int64_t multigrid_from = 300'000;

/// @param obstacle  what keeps multigrid from treating this system, a sentence's end; empty: nothing
/// @throws InputError where multigrid is asked for and there is an obstacle
SolverReport choose_solver(SolverKind asked, const NodePattern& pattern, const std::string& obstacle);

/// Bytes of the Cholesky factor and its work space, from the number of unknowns and entries a row: nested dissection of
/// a solid needs a multiple of n^(4/3) numbers. Within a factor of two of what METIS finds (README.md).
double estimated_factor_bytes(const NodePattern& pattern);

} // namespace iga::solve
