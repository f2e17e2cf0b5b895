// How much memory a factorisation may take, and the refusal of one that needs more.
#pragma once

#include "solver/linalg/linear_solver.hpp"

namespace iga::solve {

/// Bytes this process may still take without swapping: the smallest of what the system has available, what its control
/// group (container) leaves and what its address space limit (ulimit -v) leaves.
double free_memory();

/// @throws InputError where `cost.bytes` exceeds `available`, with both numbers and what helps
void require_memory(const FactorCost& cost, std::int64_t unknowns, double available);

} // namespace iga::solve
