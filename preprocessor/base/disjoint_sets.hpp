// Disjoint sets as a vector of parents; a root is its own parent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace iga::prep {

/// Root of v, with path halving.
inline std::int32_t find_root(std::vector<std::int32_t>& parent, std::int32_t v) {
  while (parent[static_cast<std::size_t>(v)] != v) {
    auto& p = parent[static_cast<std::size_t>(v)];
    p = parent[static_cast<std::size_t>(p)];
    v = p;
  }
  return v;
}

/// Joins the sets of a and b under the smaller root, so that the result does not depend on the order of the joins.
inline void join_sets(std::vector<std::int32_t>& parent, std::int32_t a, std::int32_t b) {
  a = find_root(parent, a);
  b = find_root(parent, b);
  parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

} // namespace iga::prep
