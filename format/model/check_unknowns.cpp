// The unknowns beside the ends of gaps: a sound matrix C that keeps constant and linear fields, and continuous columns.
#include "format/model/bspline_basis.hpp"
#include "format/model/model_check.hpp"

#include <algorithm>

namespace iga::detail {

namespace {

constexpr double row_tolerance = 1e-12; // relative to the factors, which reach thousands at degree 4

// Entries in range, ascending where they should.
void check_entries(const TrimmedModel& m, ProblemKind& kind) {
  const Unknowns& u = m.unknowns;
  const auto n = static_cast<std::int32_t>(u.function.size());
  const auto functions = static_cast<std::int32_t>(m.functions.number.size());
  for (std::size_t t = 0; t < u.terms.size(); ++t) {
    if (u.terms[t] < 0 || u.terms[t] >= n) kind.add("term {} names unknown {}, expected 0 to {}", t, u.terms[t], n - 1);
    if (!std::isfinite(u.weights[t])) kind.add("term {} has the factor {}", t, u.weights[t]);
  }
  bool ended = false;
  for (std::size_t k = 0; k < u.function.size(); ++k) {
    const std::int32_t f = u.function[k];
    ended = ended || f < 0;
    if (ended ? f != -1 : f >= functions || (k > 0 && f <= u.function[k - 1]))
      kind.add("unknown {} names function {}, expected ascending ones of {}, then -1", k, f, functions);
    if (!(u.mass_fraction[k] > 0 && u.mass_fraction[k] <= 1))
      kind.add("unknown {} has mass fraction {}, expected a number above 0 and at most 1", k, u.mass_fraction[k]);
  }
}

void check_row(const TrimmedModel& m, std::size_t f, ProblemKind& kind) {
  double sum = 0, size = 0;
  Point3 point{};
  std::int32_t before = -1;
  m.for_terms(static_cast<std::int32_t>(f), [&](std::int32_t unknown, double weight) {
    if (unknown <= before) kind.add("the terms of function {} do not ascend", f);
    before = unknown;
    sum += weight;
    size += std::abs(weight);
    for (std::size_t d = 0; d < 3; ++d)
      point[d] += weight * m.unknowns.parameters[3 * static_cast<std::size_t>(unknown) + d];
  });
  const Index3 ijk = m.grid.function_index(m.functions.number[f]);
  const Point3 rounding = parameter_rounding(m.grid), h = m.grid.span_size();
  bool keeps = std::abs(sum - 1) <= row_tolerance * size;
  for (std::size_t d = 0; d < 3; ++d)
    keeps = keeps && std::abs(point[d] - m.grid.knots(static_cast<int>(d)).greville(ijk[d])) <=
                         (row_tolerance + 10 * rounding[d]) * size * h[d];
  if (!keeps) kind.add("the factors of function {} do not keep constant and linear fields", f);
}

// What a cell's functions are on a face of its span: its Bernstein coefficients there as rows over `unknowns`, which
// hold all that the cell sees (ascending).
std::vector<double> trace(const TrimmedModel& m, std::size_t cell, std::size_t axis, bool upper,
                          const std::vector<std::int32_t>& unknowns) {
  const auto p = m.grid.degree();
  const Index3 e = m.grid.span_index(m.cells.span[cell]);
  std::array<std::vector<std::vector<double>>, 3> factors; // (p + 1 or 1 Bernstein coefficients) × (p + 1)
  for (std::size_t d = 0; d < 3; ++d)
    for (int k = 0; k <= p[d]; ++k)
      if (d != axis || k == (upper ? p[d] : 0))
        bernstein_weights(m.grid.knots(static_cast<int>(d)), e[d], k,
                          factors[d].emplace_back(static_cast<std::size_t>(p[d]) + 1));
  const std::size_t n = unknowns.size(), width = factors[0][0].size(), height = factors[1][0].size();
  std::vector<double> rows(n * factors[0].size() * factors[1].size() * factors[2].size(), 0.0);
  std::vector<std::pair<std::size_t, double>> terms; // place in `unknowns`, factor
  const auto functions = m.functions_of(cell);
  for (std::size_t f = 0; f < functions.size(); ++f) {
    terms.clear();
    m.for_terms(functions[f], [&](std::int32_t unknown, double weight) {
      const auto at = std::lower_bound(unknowns.begin(), unknowns.end(), unknown) - unknowns.begin();
      terms.emplace_back(static_cast<std::size_t>(at), weight);
    });
    double* row = rows.data();
    for (const auto& w : factors[2])
      for (const auto& v : factors[1])
        for (const auto& u : factors[0]) {
          const double factor = u[f % width] * v[f / width % height] * w[f / (width * height)];
          if (factor != 0)
            for (const auto& [place, weight] : terms) row[place] += factor * weight;
          row += n;
        }
  }
  return rows;
}

} // namespace

bool unknowns_fit(const TrimmedModel& m, ProblemKind& kind) {
  const Unknowns& u = m.unknowns;
  if (u.empty()) return true;
  check_offsets(u.offsets, u.terms.size(), kind);
  if (!kind.empty()) return false;
  check_entries(m, kind);
  if (!kind.empty()) return false;
  for (std::size_t f = 0; f < m.functions.number.size(); ++f) check_row(m, f, kind);
  for (std::size_t k = 0; k < u.function.size() && u.function[k] >= 0; ++k) {
    const auto f = static_cast<std::size_t>(u.function[k]), first = static_cast<std::size_t>(u.offsets[f]);
    if (u.offsets[f + 1] != u.offsets[f] + 1 || u.terms[first] != static_cast<std::int32_t>(k) || u.weights[first] != 1)
      kind.add("unknown {} is the coefficient of function {}, whose row is another one", k, f);
  }
  return kind.empty();
}

void check_continuity(const TrimmedModel& m, std::size_t link, std::size_t axis, ProblemKind& kind) {
  const auto low = static_cast<std::size_t>(m.links[link].first), high = static_cast<std::size_t>(m.links[link].second);
  std::vector<std::int32_t> unknowns;
  double size = 0; // largest sum of absolute factors of a function
  for (const std::size_t cell : {low, high})
    for (const std::int32_t f : m.functions_of(cell)) {
      double sum = 0;
      m.for_terms(f, [&](std::int32_t unknown, double weight) {
        unknowns.push_back(unknown);
        sum += std::abs(weight);
      });
      size = std::max(size, sum);
    }
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  const std::vector<double> lower = trace(m, low, axis, true, unknowns), higher = trace(m, high, axis, false, unknowns);
  for (std::size_t k = 0; k < lower.size(); ++k)
    if (!(std::abs(lower[k] - higher[k]) <= row_tolerance * size)) {
      kind.add("the function of unknown {} jumps by {:.3g} between the linked cells {} and {}",
               unknowns[k % unknowns.size()], lower[k] - higher[k], low, high);
      return;
    }
}

} // namespace iga::detail
