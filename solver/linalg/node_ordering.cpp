#include "solver/linalg/node_ordering.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/cholmod_common.hpp"

namespace iga::solve {

std::vector<std::int64_t> order_nodes(const NodePattern& pattern) {
  const auto n = static_cast<std::size_t>(pattern.num_nodes());
  const std::vector<std::int64_t> rows(pattern.rows.begin(), pattern.rows.end());
  std::vector<std::int64_t> order(n);
  cholmod_sparse graph = lower_triangle(n, pattern.offsets, rows, nullptr);
  CholmodCommon common;
  // METIS has nothing to cut in a graph of one node, and CHOLMOD guards it against graphs it has no memory for: the
  // minimum degree order is always there.
  if (n < 2 || !cholmod_l_metis(&graph, nullptr, 0, 1, order.data(), common.get()))
    if (!cholmod_l_amd(&graph, nullptr, 0, order.data(), common.get()))
      throw InputError("not enough memory to order the unknowns of this model; use larger spans");
  return order;
}

std::vector<std::int64_t> expand_order(std::span<const std::int64_t> node_order, int components) {
  std::vector<std::int64_t> order;
  order.reserve(node_order.size() * static_cast<std::size_t>(components));
  for (const std::int64_t node : node_order)
    for (int c = 0; c < components; ++c) order.push_back(components * node + c);
  return order;
}

} // namespace iga::solve
