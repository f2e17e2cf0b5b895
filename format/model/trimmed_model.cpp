// check(TrimmedModel): shapes first, because everything else indexes by them; then states, volume, functions, surface.
#include "format/model/trimmed_model.hpp"

#include "format/model/disjoint_sets.hpp"
#include "format/model/model_check.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace iga {

namespace detail {

Point3 parameter_rounding(const SplineGrid& grid) {
  double largest = 0;
  for (std::size_t d = 0; d < 3; ++d) largest = std::max({largest, std::abs(grid.A()[d]), std::abs(grid.B()[d])});
  Point3 rounding{};
  // Sixteen units in the last place cover the subtraction of C, the rotation and a clamp.
  for (std::size_t d = 0; d < 3; ++d)
    rounding[d] = 16 * std::numeric_limits<double>::epsilon() * largest / grid.span_size()[d];
  return rounding;
}

double volume_rounding(const SplineGrid& grid) {
  const Point3 r = parameter_rounding(grid);
  return 1e-12 + r[0] + r[1] + r[2];
}

bool in_closed_span(const SplineGrid& grid, const Index3& span, const double* u, const Point3& rounding) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto& knots = grid.knots(static_cast<int>(d));
    const double slack = std::max(inside_tolerance, rounding[d]) * grid.span_size()[d];
    if (!(u[d] >= knots.lower(span[d]) - slack && u[d] <= knots.upper(span[d]) + slack)) return false;
  }
  return true;
}

void check_offsets(const std::vector<std::int64_t>& offsets, std::size_t count, ProblemKind& kind) {
  if (offsets.front() != 0) kind.add("the first offset is {}, expected 0", offsets.front());
  for (std::size_t a = 1; a < offsets.size(); ++a)
    if (offsets[a] < offsets[a - 1]) kind.add("offset {} falls from {} to {}", a, offsets[a - 1], offsets[a]);
  if (offsets.back() != static_cast<std::int64_t>(count))
    kind.add("the last offset is {}, expected the number of points {}", offsets.back(), count);
}

} // namespace detail

std::pair<std::size_t, std::size_t> TrimmedModel::cells_of(std::int64_t number) const {
  const auto [first, last] = std::equal_range(cells.span.begin(), cells.span.end(), number);
  return {static_cast<std::size_t>(first - cells.span.begin()), static_cast<std::size_t>(last - cells.span.begin())};
}

namespace {

using detail::ProblemKind;

template <class T>
void expect_size(const std::vector<T>& array, std::size_t expected, const char* name, ProblemKind& kind) {
  if (array.size() != expected) kind.add("{} has {} entries, expected {}", name, array.size(), expected);
}

bool shapes_fit(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "shape");
  for (std::size_t d = 0; d < 3; ++d)
    if (m.grid.spans()[d] < 1) kind.add("the grid has no spans along {}", "uvw"[d]);
  if (!kind.empty()) return false;
  const std::size_t cells = m.num_cells(), points = m.points.weights.size();
  const auto& s = m.surface;
  const std::size_t surface_points = s.quadrature.weights.size(), vertices = s.mesh.vertices.size();
  const auto p = m.grid.degree();
  const auto local = static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
  expect_size(m.state, static_cast<std::size_t>(m.grid.num_spans()), "spans/state", kind);
  expect_size(m.cells.state, cells, "cells/state", kind);
  expect_size(m.cells.volume_fraction, cells, "cells/volume_fraction", kind);
  expect_size(m.cells.functions, cells * local, "cells/functions", kind);
  expect_size(m.points.offsets, cells + 1, "quadrature/offsets", kind);
  expect_size(m.points.parameters, 3 * points, "quadrature/parameters", kind);
  expect_size(m.points.residual, cells, "quadrature/residual", kind);
  expect_size(m.functions.mass_fraction, m.functions.number.size(), "functions/mass_fraction", kind);
  if (const Unknowns& u = m.unknowns; !u.empty()) {
    expect_size(u.offsets, m.functions.number.size() + 1, "unknowns/offsets", kind);
    expect_size(u.weights, u.terms.size(), "unknowns/weights", kind);
    expect_size(u.parameters, 3 * u.function.size(), "unknowns/parameters", kind);
    expect_size(u.mass_fraction, u.function.size(), "unknowns/mass_fraction", kind);
  }
  expect_size(s.vertex_parameters, 3 * vertices, "surface/vertex_parameters", kind);
  expect_size(s.vertex_cell, vertices, "surface/vertex_cell", kind);
  expect_size(s.mesh.region, s.mesh.triangles.size(), "surface/region", kind);
  expect_size(s.quadrature.offsets, cells + 1, "surface/quadrature/offsets", kind);
  expect_size(s.quadrature.parameters, 3 * surface_points, "surface/quadrature/parameters", kind);
  expect_size(s.quadrature.normals, 3 * surface_points, "surface/quadrature/normals", kind);
  expect_size(s.quadrature.triangle, surface_points, "surface/quadrature/triangle", kind);
  if (m.links.cells.size() % 2 != 0) kind.add("links/cells has {} entries, expected pairs", m.links.cells.size());
  if (cells == 0) kind.add("there is no cell");
  if (s.mesh.region_names.empty()) kind.add("surface/regions is empty, expected at least one region");
  return kind.empty();
}

bool states_fit(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "spans/state against cells/span");
  const auto& span = m.cells.span;
  std::size_t next = 0;
  for (std::size_t e = 0; e < m.state.size(); ++e) {
    if (m.state[e] == 0) continue;
    if (m.state[e] > 2) kind.add("span {} has state {}, expected 0, 1 or 2", e, m.state[e]);
    // Where the two lists part, every later span would be reported too: stop at the first difference.
    if (next == span.size() || span[next] != static_cast<std::int64_t>(e)) {
      kind.add("span {} is not exterior but entry {} of cells/span is {}", e, next,
               next == span.size() ? std::string("missing") : fmt::to_string(span[next]));
      return false;
    }
    const std::size_t first = next;
    for (; next < span.size() && span[next] == static_cast<std::int64_t>(e); ++next)
      if (m.cells.state[next] != m.state[e])
        kind.add("cell {} has state {}, expected that of its span {}, which is {}", next, m.cells.state[next], e,
                 m.state[e]);
    if (m.state[e] == 1 && next - first > 1) kind.add("interior span {} has {} cells, expected one", e, next - first);
  }
  if (next != span.size()) kind.add("entry {} of cells/span is {}, expected no further span", next, span[next]);
  return kind.empty();
}

} // namespace

namespace {

template <class Seen> FunctionCells invert(std::size_t num_functions, std::size_t num_cells, const Seen& seen) {
  FunctionCells out;
  out.first.assign(num_functions + 1, 0);
  for (std::size_t c = 0; c < num_cells; ++c)
    for (const std::int32_t f : seen(c)) ++out.first[static_cast<std::size_t>(f) + 1];
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.cells.resize(out.first.back());
  std::vector<std::size_t> next(out.first.begin(), out.first.end() - 1);
  for (std::size_t c = 0; c < num_cells; ++c)
    for (const std::int32_t f : seen(c)) out.cells[next[static_cast<std::size_t>(f)]++] = static_cast<std::int32_t>(c);
  return out;
}

} // namespace

FunctionCells cells_by_function(const TrimmedModel& model) {
  return invert(model.functions.number.size(), model.num_cells(), [&](std::size_t c) { return model.functions_of(c); });
}

CellUnknowns::CellUnknowns(const TrimmedModel& model) : model_(&model) {
  if (model.unknowns.empty()) return;
  first_.push_back(0);
  for (std::size_t c = 0; c < model.num_cells(); ++c) {
    const auto begin = static_cast<std::ptrdiff_t>(unknowns_.size());
    for (const std::int32_t f : model.functions_of(c))
      model.for_terms(f, [&](std::int32_t unknown, double) { unknowns_.push_back(unknown); });
    std::sort(unknowns_.begin() + begin, unknowns_.end());
    unknowns_.erase(std::unique(unknowns_.begin() + begin, unknowns_.end()), unknowns_.end());
    first_.push_back(unknowns_.size());
  }
}

FunctionCells CellUnknowns::by_unknown() const {
  return invert(model_->num_unknowns(), model_->num_cells(), [&](std::size_t c) { return of(c); });
}

std::size_t CellLinks::first_from(std::pair<std::int32_t, std::int32_t> pair) const {
  std::size_t first = 0, last = size(); // of a search by halves: clang 14 does not take views of g++'s library
  while (first < last) {
    const std::size_t middle = first + (last - first) / 2;
    if ((*this)[middle] < pair)
      first = middle + 1;
    else
      last = middle;
  }
  return first;
}

std::vector<std::int32_t> connected_parts(const TrimmedModel& model) {
  std::vector<std::int32_t> sets = lone_sets(model.num_cells());
  for (std::size_t l = 0; l < model.links.size(); ++l) join_sets(sets, model.links[l].first, model.links[l].second);
  for (std::size_t c = 0; c < sets.size(); ++c) sets[c] = find_root(sets, static_cast<std::int32_t>(c));
  return sets;
}

bool TrimmedModel::is_at_gap_end(std::size_t cell) const {
  if (unknowns.empty()) return false;
  // A function that is an unknown has one term; those of a cell at a gap end are all its own, and follow from others.
  const auto f = static_cast<std::size_t>(functions_of(cell).front());
  const auto first = static_cast<std::size_t>(unknowns.offsets[f]);
  return unknowns.offsets[f + 1] != unknowns.offsets[f] + 1 ||
         unknowns.function[static_cast<std::size_t>(unknowns.terms[first])] != static_cast<std::int32_t>(f);
}

CellCounts count_cells(const TrimmedModel& model) {
  CellCounts counts;
  // Each run of equal numbers counts once, at its second entry.
  const auto repeated = [](const std::vector<std::int64_t>& numbers) {
    std::int64_t count = 0;
    for (std::size_t i = 1; i < numbers.size(); ++i)
      count += numbers[i] == numbers[i - 1] && (i < 2 || numbers[i] != numbers[i - 2]);
    return count;
  };
  counts.split_spans = repeated(model.cells.span);
  std::vector<std::uint8_t> own(model.functions.number.size(), 0);
  for (std::size_t c = 0; c < model.num_cells(); ++c)
    if (model.is_at_gap_end(c)) {
      ++counts.gap_end_cells;
      for (const std::int32_t f : model.functions_of(c)) own[static_cast<std::size_t>(f)] = 1;
    }
  std::vector<std::int64_t> shared;
  for (std::size_t f = 0; f < own.size(); ++f)
    if (!own[f]) shared.push_back(model.functions.number[f]);
  counts.copied_functions = repeated(shared);
  counts.components = count_sets(connected_parts(model));
  return counts;
}

std::vector<std::string> check(const TrimmedModel& model, int limit) {
  std::vector<std::string> problems;
  if (!shapes_fit(model, limit, problems) || !states_fit(model, limit, problems)) return problems;
  detail::check_places(model, limit, problems);
  detail::check_volume(model, limit, problems);
  if (!detail::cells_fit(model, limit, problems)) return problems;
  detail::check_functions(model, limit, problems);
  detail::check_surface(model, limit, problems);
  return problems;
}

} // namespace iga
