// Fill-reducing elimination order of the nodes, found on their own graph: nine times smaller than that of the unknowns.
#pragma once

#include "solver/linalg/symmetric_matrix.hpp"

namespace iga::solve {

/// Nested dissection by METIS: order[k] is the node that is eliminated k-th. (num_nodes)
std::vector<std::int64_t> order_nodes(const NodePattern& pattern);

/// The order of the unknowns: each node's components one after the other. (components × num_nodes)
std::vector<std::int64_t> expand_order(std::span<const std::int64_t> node_order, int components);

} // namespace iga::solve
