// Which functions each cell sees, that copies and links agree, and the functions' mass fractions.
#include "format/model/bspline_basis.hpp"
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
    if (!links_fit() || !numbers_fit() || !rows_fit()) return false;
    for (std::size_t c = 0; c < m_.num_cells(); ++c) at_gap_end_.push_back(m_.is_at_gap_end(c));
    join_cells();
    return kind_.empty() && rows_.empty();
  }

 private:
  std::size_t num_links() const { return m_.links.cells.size() / 2; }
  std::int64_t low(std::size_t l) const { return m_.links.cells[2 * l]; }
  std::int64_t high(std::size_t l) const { return m_.links.cells[2 * l + 1]; }

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

  // The matrix C of coefficients from unknowns: entries in range, constant and linear fields are kept.
  bool rows_fit() {
    const Unknowns& u = m_.unknowns;
    if (u.empty()) return true;
    check_offsets(u.offsets, u.terms.size(), rows_);
    if (!rows_.empty()) return false;
    const auto n = static_cast<std::int32_t>(u.function.size());
    const auto functions = static_cast<std::int32_t>(m_.functions.number.size());
    for (std::size_t t = 0; t < u.terms.size(); ++t) {
      if (u.terms[t] < 0 || u.terms[t] >= n)
        rows_.add("term {} names unknown {}, expected 0 to {}", t, u.terms[t], n - 1);
      if (!std::isfinite(u.weights[t])) rows_.add("term {} has the factor {}", t, u.weights[t]);
    }
    bool ended = false;
    for (std::size_t k = 0; k < u.function.size(); ++k) {
      const std::int32_t f = u.function[k];
      ended = ended || f < 0;
      if (ended ? f != -1 : f >= functions || (k > 0 && f <= u.function[k - 1]))
        rows_.add("unknown {} names function {}, expected ascending ones of {}, then -1", k, f, functions);
      if (!(u.mass_fraction[k] > 0 && u.mass_fraction[k] <= 1))
        rows_.add("unknown {} has mass fraction {}, expected a number above 0 and at most 1", k, u.mass_fraction[k]);
    }
    if (!rows_.empty()) return false;
    const Point3 rounding = parameter_rounding(m_.grid), h = m_.grid.span_size();
    for (std::size_t f = 0; f < m_.functions.number.size(); ++f) {
      const auto first = static_cast<std::size_t>(u.offsets[f]), last = static_cast<std::size_t>(u.offsets[f + 1]);
      double sum = 0, size = 0; // factors of both signs reach thousands at degree 4
      Point3 point{};
      for (std::size_t t = first; t < last; ++t) {
        if (t > first && u.terms[t] <= u.terms[t - 1]) rows_.add("the terms of function {} do not ascend", f);
        sum += u.weights[t];
        size += std::abs(u.weights[t]);
        for (std::size_t d = 0; d < 3; ++d)
          point[d] += u.weights[t] * u.parameters[3 * static_cast<std::size_t>(u.terms[t]) + d];
      }
      const Index3 ijk = m_.grid.function_index(m_.functions.number[f]);
      bool keeps = std::abs(sum - 1) <= row_tolerance * size;
      for (std::size_t d = 0; d < 3; ++d)
        keeps = keeps && std::abs(point[d] - m_.grid.knots(static_cast<int>(d)).greville(ijk[d])) <=
                             (row_tolerance + 10 * rounding[d]) * size * h[d];
      if (!keeps) rows_.add("the factors of function {} do not keep constant and linear fields", f);
    }
    for (std::size_t k = 0; k < u.function.size() && u.function[k] >= 0; ++k) {
      const auto f = static_cast<std::size_t>(u.function[k]);
      const auto first = static_cast<std::size_t>(u.offsets[f]);
      if (u.offsets[f + 1] != u.offsets[f] + 1 || u.terms[first] != static_cast<std::int32_t>(k) ||
          u.weights[first] != 1)
        rows_.add("unknown {} is the coefficient of function {}, whose row is another one", k, f);
    }
    return rows_.empty();
  }

  // What a cell's functions are on a face of its span: its Bernstein coefficients there as rows over `unknowns`, which
  // hold all that the cell sees (ascending).
  std::vector<double> trace(std::int64_t cell, std::size_t axis, bool upper,
                            const std::vector<std::int32_t>& unknowns) const {
    const auto p = m_.grid.degree();
    const Index3 e = span(cell);
    const auto functions = m_.functions_of(static_cast<std::size_t>(cell));
    std::array<std::vector<std::vector<double>>, 3> factors; // (p + 1 or 1 Bernstein coefficients) × (p + 1)
    for (std::size_t d = 0; d < 3; ++d) {
      const KnotVector& knots = m_.grid.knots(static_cast<int>(d));
      const auto degree = static_cast<std::size_t>(p[d]);
      for (std::size_t k = 0; k <= degree; ++k) {
        if (d == axis && k != (upper ? degree : 0)) continue;
        std::vector<double> arguments(degree, knots.lower(e[d])), weights(degree + 1);
        std::fill_n(arguments.begin(), k, knots.upper(e[d]));
        blossom_weights(knots, e[d], arguments, weights);
        factors[d].push_back(std::move(weights));
      }
    }
    const std::size_t n = unknowns.size(), coefficients = factors[0].size() * factors[1].size() * factors[2].size();
    std::vector<double> rows(n * coefficients, 0.0);
    std::vector<std::size_t> place;
    for (std::size_t f = 0; f < functions.size(); ++f) {
      const auto first = static_cast<std::size_t>(m_.unknowns.offsets[static_cast<std::size_t>(functions[f])]);
      const auto last = static_cast<std::size_t>(m_.unknowns.offsets[static_cast<std::size_t>(functions[f]) + 1]);
      place.clear();
      for (std::size_t t = first; t < last; ++t)
        place.push_back(static_cast<std::size_t>(
            std::lower_bound(unknowns.begin(), unknowns.end(), m_.unknowns.terms[t]) - unknowns.begin()));
      const std::size_t width = factors[0][0].size(), height = factors[1][0].size();
      double* row = rows.data();
      for (const auto& w : factors[2])
        for (const auto& v : factors[1])
          for (const auto& u : factors[0]) {
            const double factor = u[f % width] * v[f / width % height] * w[f / (width * height)];
            if (factor != 0)
              for (std::size_t t = first; t < last; ++t) row[place[t - first]] += factor * m_.unknowns.weights[t];
            row += n;
          }
    }
    return rows;
  }

  // Largest sum of absolute factors of a cell's functions.
  double factor_size(std::int64_t cell) const {
    double most = 0;
    for (const std::int32_t f : m_.functions_of(static_cast<std::size_t>(cell))) {
      double sum = 0;
      for (auto t = m_.unknowns.offsets[static_cast<std::size_t>(f)];
           t < m_.unknowns.offsets[static_cast<std::size_t>(f) + 1]; ++t)
        sum += std::abs(m_.unknowns.weights[static_cast<std::size_t>(t)]);
      most = std::max(most, sum);
    }
    return most;
  }

  void expect_continuous(std::size_t l, std::size_t axis) {
    const double bound = row_tolerance * std::max(factor_size(low(l)), factor_size(high(l)));
    std::vector<std::int32_t> unknowns;
    for (const std::int64_t cell : {low(l), high(l)})
      for (const std::int32_t f : m_.functions_of(static_cast<std::size_t>(cell)))
        unknowns.insert(unknowns.end(), m_.unknowns.terms.begin() + m_.unknowns.offsets[static_cast<std::size_t>(f)],
                        m_.unknowns.terms.begin() + m_.unknowns.offsets[static_cast<std::size_t>(f) + 1]);
    std::sort(unknowns.begin(), unknowns.end());
    unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
    const std::vector<double> lower = trace(low(l), axis, true, unknowns),
                              higher = trace(high(l), axis, false, unknowns);
    for (std::size_t k = 0; k < lower.size(); ++k)
      if (!(std::abs(lower[k] - higher[k]) <= bound)) {
        rows_.add("the function of unknown {} jumps by {:.3g} between the linked cells {} and {}",
                  unknowns[k % unknowns.size()], lower[k] - higher[k], low(l), high(l));
        return;
      }
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
            if (at_gap_end_[c]) add(static_cast<std::int64_t>(c));
        }
    std::vector<std::int32_t> sets = lone_sets(place.size());
    for (const auto& [cell, number_here] : place) {
      std::size_t first = 0, count = num_links(); // the links are sorted by their lower cells
      while (count > 0) {
        const std::size_t half = count / 2;
        const bool before = low(first + half) < cell;
        first += before ? half + 1 : 0;
        count = before ? count - half - 1 : half;
      }
      for (std::size_t l = first; l < num_links() && low(l) == cell; ++l)
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
      if (at_gap_end_[static_cast<std::size_t>(low(l))] || at_gap_end_[static_cast<std::size_t>(high(l))]) {
        expect_continuous(l, axis);
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

  static constexpr double row_tolerance = 1e-12; // relative to the factors

  const TrimmedModel& m_;
  ProblemKind kind_, links_, rows_;
  std::vector<std::uint8_t> at_gap_end_; // (num_cells)
};

// ∫ N over the whole grid: Π (U[i + p + 1] - U[i]) / (p + 1). Piegl & Tiller (1997), exercise of section 2.
double integral_of(const SplineGrid& grid, std::int64_t function) {
  const Index3 ijk = grid.function_index(function);
  double product = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto& knots = grid.knots(static_cast<int>(d));
    const auto i = static_cast<std::size_t>(ijk[d]);
    const auto order = static_cast<std::size_t>(knots.degree() + 1);
    product *= (knots.values()[i + order] - knots.values()[i]) / static_cast<double>(order);
  }
  return product;
}

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
    from_functions.add(chi * integral_of(m.grid, m.functions.number[f]));
  }
  for (const double w : m.points.weights) from_points.add(w);
  // The functions sum to one everywhere.
  if (kind.empty() &&
      !(std::abs(from_functions.value() - from_points.value()) <= integral_tolerance * from_points.value()))
    kind.add("Σ mass fraction · ∫ N = {:.17g}, expected the sum of the weights {:.17g}", from_functions.value(),
             from_points.value());
}

} // namespace iga::detail
