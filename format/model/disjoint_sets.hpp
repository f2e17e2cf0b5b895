// Disjoint sets as a vector of parents; a root is its own parent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace iga {

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

/// Sets of n elements, each alone.
inline std::vector<std::int32_t> lone_sets(std::size_t n) {
  std::vector<std::int32_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  return parent;
}

inline std::int64_t count_sets(const std::vector<std::int32_t>& parent) {
  std::int64_t count = 0;
  for (std::size_t v = 0; v < parent.size(); ++v) count += parent[v] == static_cast<std::int32_t>(v);
  return count;
}

} // namespace iga
