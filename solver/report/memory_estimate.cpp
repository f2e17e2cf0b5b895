#include "solver/report/memory_estimate.hpp"

#include "solver/analysis/run_settings.hpp"
#include "solver/linalg/cholmod_common.hpp"
#include "solver/linalg/node_ordering.hpp"
#include "solver/report/analysis_report.hpp"

#include <algorithm>
#include <new>

namespace iga::solve {

namespace {

// Nonzeros of the Cholesky factor of a matrix over the nodes.
double node_factor_nonzeros(const NodePattern& pattern) {
  CholmodCommon common;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  common->supernodal = CHOLMOD_SUPERNODAL;
  std::vector<std::int64_t> offsets = pattern.offsets, rows(pattern.rows.begin(), pattern.rows.end());
  const auto order = order_nodes(pattern);
  std::vector<SuiteSparse_long> permutation(order.begin(), order.end());
  cholmod_sparse A = lower_triangle(static_cast<std::size_t>(pattern.num_nodes()), offsets, rows, nullptr);
  A.xtype = CHOLMOD_PATTERN;
  cholmod_factor* factor = cholmod_l_analyze_p(&A, permutation.data(), nullptr, 0, common.get());
  if (!factor) throw std::bad_alloc();
  const double nonzeros = common->lnz;
  cholmod_l_free_factor(&factor, common.get());
  return nonzeros;
}

} // namespace

MemoryEstimate estimate_memory(const TrimmedModel& model) {
  const SolutionSpace space(model, default_light_treatment(MassType::Consistent));
  const Connectivity connectivity(space);
  const auto pairs = static_cast<double>(connectivity.pattern.num_pairs());
  const auto unknowns = static_cast<double>(space.num_unknowns());
  const double before = 1024 * 1024 * peak_memory_mib(); // the model and the space are there already
  // Three components a node: nine times the entries, in the matrix as in the factor.
  const double entries = 9 * pairs;
  MemoryEstimate need;
  need.factor_nonzeros = 9 * node_factor_nonzeros(connectivity.pattern);
  const double factor = 8.8 * need.factor_nonzeros; // a tenth for zeros in supernodes and for indices
  const double stiffness = 8 * entries;
  // The matrix by columns (values, rows), and CHOLMOD's two permuted copies of it.
  const double factorisation = stiffness + factor + (16 + 32) * entries + 64 * unknowns;
  constexpr double lanczos_vectors = 2 * 77; // a basis for ten modes, and the mass times it
  // The Sturm count: entries by row and column, MUMPS's stack of fronts beside the factor of the search.
  const double count = stiffness + factor + 16 * entries + 0.7 * factor + 8 * lanczos_vectors * unknowns;
  need.statics = before + factorisation;
  need.eigen = before + 8 * pairs + std::max(factorisation, unknowns < sturm_default ? count : 0);
  return need;
}

} // namespace iga::solve
