#include "format/model/glue_gap_ends.hpp"

#include "format/model/disjoint_sets.hpp"

namespace iga {

namespace {

// Joins the functions of two linked cells that belong to the same B-spline. A cell's functions ascend by B-spline.
void join_common(const TrimmedModel& m, std::span<const std::int32_t> a, std::span<const std::int32_t> b,
                 std::vector<std::int32_t>& sets) {
  const auto number = [&](std::int32_t f) { return m.functions.number[static_cast<std::size_t>(f)]; };
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const std::int64_t left = number(a[i]), right = number(b[j]);
    if (left == right) join_sets(sets, a[i], b[j]);
    i += left <= right;
    j += right <= left;
  }
}

} // namespace

TrimmedModel glue_gap_ends(TrimmedModel m) {
  if (m.unknowns.empty()) return m;
  std::vector<std::int32_t> sets = lone_sets(m.functions.number.size());
  for (std::size_t l = 0; l < m.links.size(); ++l) {
    const auto [a, b] = m.links[l];
    join_common(m, m.functions_of(static_cast<std::size_t>(a)), m.functions_of(static_cast<std::size_t>(b)), sets);
  }
  // Roots are the lowest of their sets, so that the order by B-spline stays.
  Functions glued;
  std::vector<std::int32_t> entry(sets.size());
  for (std::size_t f = 0; f < sets.size(); ++f) {
    const auto root = static_cast<std::size_t>(find_root(sets, static_cast<std::int32_t>(f)));
    if (root == f) {
      entry[f] = static_cast<std::int32_t>(glued.number.size());
      glued.number.push_back(m.functions.number[f]);
      glued.mass_fraction.push_back(0);
    }
    entry[f] = entry[root];
    glued.mass_fraction[static_cast<std::size_t>(entry[f])] += m.functions.mass_fraction[f];
  }
  for (std::int32_t& f : m.cells.functions) f = entry[static_cast<std::size_t>(f)];
  m.functions = std::move(glued);
  m.unknowns = {};
  return m;
}

} // namespace iga
