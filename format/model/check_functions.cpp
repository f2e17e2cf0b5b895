// Which functions each cell sees, that copies and links agree, and the functions' mass fractions.
#include "format/model/disjoint_sets.hpp"
#include "format/model/model_check.hpp"

#include <algorithm>
#include <map>

namespace iga::detail {

namespace {

/// Cells of a copy and links among them.
class CopyCheck {
 public:
  CopyCheck(const TrimmedModel& m, int limit, std::vector<std::string>& problems)
      : m_(m), kind_(problems, limit, "cells/functions"), links_(problems, limit, "links/cells"),
        rows_(problems, limit, "unknowns") {}

  bool run() {
    if (!links_fit() || !numbers_fit() || !unknowns_fit(m_, rows_)) return false;
    join_cells();
    return kind_.empty() && rows_.empty();
  }

 private:
  std::size_t num_links() const { return m_.links.size(); }
  std::int64_t low(std::size_t l) const { return m_.links[l].first; }
  std::int64_t high(std::size_t l) const { return m_.links[l].second; }

  bool links_fit() {
    const auto cells = static_cast<std::int64_t>(m_.num_cells());
    for (std::size_t l = 0; l < num_links(); ++l) {
      if (low(l) < 0 || high(l) >= cells || low(l) >= high(l)) {
        links_.add("link {} joins cells {} and {} of {}, expected a lower and a higher one", l, low(l), high(l), cells);
        continue;
      }
      if (l > 0 && std::pair(low(l - 1), high(l - 1)) >= std::pair(low(l), high(l)))
        links_.add("link {} does not come after the one before, expected ascending pairs", l);
      const Index3 a = span(low(l)), b = span(high(l));
      std::int64_t apart = 0;
      for (std::size_t d = 0; d < 3; ++d) apart += std::abs(a[d] - b[d]);
      if (apart != 1) links_.add("link {} joins cells {} and {}, whose spans share no face", l, low(l), high(l));
    }
    return links_.empty();
  }

  Index3 span(std::int64_t cell) const { return m_.grid.span_index(m_.cells.span[static_cast<std::size_t>(cell)]); }

  bool numbers_fit() {
    const auto& number = m_.functions.number;
    const auto p = m_.grid.degree();
    const auto functions = static_cast<std::int64_t>(number.size());
    std::vector<std::uint8_t> seen(number.size(), 0);
    for (std::size_t c = 0; c < m_.num_cells(); ++c) {
      const Index3 e = span(static_cast<std::int64_t>(c));
      const auto own = m_.functions_of(c);
      std::size_t k = 0;
      for (std::int64_t w = 0; w <= p[2]; ++w)
        for (std::int64_t v = 0; v <= p[1]; ++v)
          for (std::int64_t u = 0; u <= p[0]; ++u, ++k) {
            const std::int32_t f = own[k];
            const std::int64_t expected = m_.grid.function_number({e[0] + u, e[1] + v, e[2] + w});
            if (f < 0 || f >= functions)
              kind_.add("cell {} names function {}, expected 0 to {}", c, f, functions - 1);
            else if (number[static_cast<std::size_t>(f)] != expected)
              kind_.add("entry {} of cell {} is a copy of the B-spline {}, expected {}", k, c,
                        number[static_cast<std::size_t>(f)], expected);
            else
              seen[static_cast<std::size_t>(f)] = 1;
          }
    }
    for (std::size_t f = 0; f < number.size(); ++f) {
      if (f > 0 && number[f] < number[f - 1])
        kind_.add("functions/number falls from {} to {} at entry {}", number[f - 1], number[f], f);
      if (!seen[f]) kind_.add("function {} belongs to no cell", f);
    }
    return kind_.empty();
  }

  // Are a function's cells joined by links inside its support once cells at gap ends, which have B-splines of their
  // own, may stand between them?
  bool joined_through_gap_ends(std::span<const std::int32_t> cells, std::int64_t number) const {
    if (m_.unknowns.empty()) return false;
    const Index3 i = m_.grid.function_index(number);
    const auto p = m_.grid.degree();
    std::map<std::int64_t, std::int32_t> place; // of cells that may stand between, and the function's own
    const auto add = [&](std::int64_t cell) { place.emplace(cell, static_cast<std::int32_t>(place.size())); };
    for (const std::int32_t c : cells) add(c);
    const auto own = static_cast<std::size_t>(place.size());
    Index3 s;
    for (s[2] = i[2] - p[2]; s[2] <= i[2]; ++s[2])
      for (s[1] = i[1] - p[1]; s[1] <= i[1]; ++s[1])
        for (s[0] = i[0] - p[0]; s[0] <= i[0]; ++s[0]) {
          bool inside = true;
          for (std::size_t d = 0; d < 3; ++d) inside = inside && s[d] >= 0 && s[d] < m_.grid.spans()[d];
          if (!inside) continue;
          const auto [first, last] = m_.cells_of(m_.grid.span_number(s));
          for (std::size_t c = first; c < last; ++c)
            if (m_.is_at_gap_end(c)) add(static_cast<std::int64_t>(c));
        }
    std::vector<std::int32_t> sets = lone_sets(place.size());
    for (const auto& [cell, number_here] : place) {
      for (std::size_t l = m_.links.first_from({static_cast<std::int32_t>(cell), 0}); l < num_links() && low(l) == cell;
           ++l)
        if (const auto other = place.find(high(l)); other != place.end()) join_sets(sets, number_here, other->second);
    }
    for (std::size_t k = 1; k < own; ++k)
      if (find_root(sets, static_cast<std::int32_t>(k)) != find_root(sets, 0)) return false;
    return true;
  }

  // A copy's cells under its links: one set each.
  void join_cells() {
    const FunctionCells by_function = cells_by_function(m_);
    std::vector<std::int32_t> sets =
        lone_sets(by_function.cells.size()); // one element for each pair of function and cell
    const auto place = [&](std::int32_t f, std::int64_t cell) {
      const auto own = by_function.of(f);
      const auto at = std::lower_bound(own.begin(), own.end(), static_cast<std::int32_t>(cell)) - own.begin();
      return static_cast<std::int32_t>(by_function.first[static_cast<std::size_t>(f)]) + static_cast<std::int32_t>(at);
    };
    const auto p = m_.grid.degree();
    for (std::size_t l = 0; l < num_links(); ++l) {
      const auto a = m_.functions_of(static_cast<std::size_t>(low(l))),
                 b = m_.functions_of(static_cast<std::size_t>(high(l)));
      // The functions that reach both spans: all but the first ones of the lower span along the way to the higher.
      const Index3 from = span(low(l)), to = span(high(l));
      std::size_t stride = 1, axis = 0;
      for (; from[axis] == to[axis]; ++axis) stride *= static_cast<std::size_t>(p[axis] + 1);
      if (m_.is_at_gap_end(static_cast<std::size_t>(low(l))) || m_.is_at_gap_end(static_cast<std::size_t>(high(l)))) {
        check_continuity(m_, l, axis, rows_);
        continue;
      }
      for (std::size_t k = 0; k < a.size(); ++k) {
        if (k / stride % static_cast<std::size_t>(p[axis] + 1) == 0) continue;
        const std::int32_t f = a[k], other = b[k - stride];
        if (other != f)
          links_.add("cells {} and {} see different copies ({}, {}) of the B-spline {}, which reaches both", low(l),
                     high(l), f, other, m_.functions.number[static_cast<std::size_t>(f)]);
        else
          join_sets(sets, place(f, low(l)), place(f, high(l)));
      }
    }
    for (std::size_t f = 0; f < m_.functions.number.size(); ++f) {
      std::int64_t groups = 0;
      for (std::size_t i = by_function.first[f]; i < by_function.first[f + 1]; ++i)
        groups += sets[i] == static_cast<std::int32_t>(i);
      if (groups != 1 && !joined_through_gap_ends(by_function.of(static_cast<std::int64_t>(f)), m_.functions.number[f]))
        kind_.add("function {} lies on {} groups of cells that no links inside its support join, expected one", f,
                  groups);
    }
  }

  const TrimmedModel& m_;
  ProblemKind kind_, links_, rows_;
};

} // namespace

bool cells_fit(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  return CopyCheck(m, limit, problems).run();
}

void check_functions(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "functions/mass_fraction");
  // The points reproduce moments to `tolerance` only, so a function that is full up to a hair may come out above one.
  const double largest = 1 + volume_rounding(m.grid) + moment_error(m.quadrature);
  Sum from_functions, from_points;
  for (std::size_t f = 0; f < m.functions.mass_fraction.size(); ++f) {
    const double chi = m.functions.mass_fraction[f];
    if (!(chi > 0 && chi <= largest))
      kind.add("function {} has mass fraction {}, expected a number above 0 and at most 1", m.functions.number[f], chi);
    from_functions.add(chi * m.grid.integral(m.grid.function_index(m.functions.number[f])));
  }
  for (const double w : m.points.weights) from_points.add(w);
  // The functions sum to one everywhere.
  if (kind.empty() &&
      !(std::abs(from_functions.value() - from_points.value()) <= integral_tolerance * from_points.value()))
    kind.add("Σ mass fraction · ∫ N = {:.17g}, expected the sum of the weights {:.17g}", from_functions.value(),
             from_points.value());
}

} // namespace iga::detail
