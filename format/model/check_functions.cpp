// The list of functions that touch material, and their mass fractions.
#include "format/model/model_check.hpp"

#include <algorithm>

namespace iga::detail {

namespace {

// Marks the functions (i, j) of one layer of spans: those whose support along u and v meets an active span of the
// layer.
void mark_layer(const TrimmedModel& m, std::int64_t layer, std::size_t& next, std::vector<std::uint8_t>& marks) {
  std::fill(marks.begin(), marks.end(), std::uint8_t{0});
  const auto degree = m.grid.degree();
  const auto n = m.grid.functions();
  for (; next < m.active.size(); ++next) {
    const Index3 e = m.grid.span_index(m.active[next]);
    if (e[2] != layer) break;
    for (std::int64_t j = e[1]; j <= e[1] + degree[1]; ++j) {
      const auto row = marks.begin() + (j * n[0] + e[0]);
      std::fill(row, row + degree[0] + 1, std::uint8_t{1});
    }
  }
}

// Calls visit(number) for all functions whose support holds an active span, ascending. Memory: p + 2 layers of
// functions.
template <class Visit> void for_each_function(const TrimmedModel& m, Visit visit) {
  const auto n = m.grid.functions();
  const auto depth = static_cast<std::size_t>(m.grid.degree()[2] + 1);
  const auto layer_size = static_cast<std::size_t>(n[0] * n[1]);
  std::vector<std::vector<std::uint8_t>> layers(depth, std::vector<std::uint8_t>(layer_size, 0));
  std::vector<std::uint8_t> any(layer_size);
  std::size_t next = 0;
  for (std::int64_t k = 0; k < n[2]; ++k) {
    mark_layer(m, k, next, layers[static_cast<std::size_t>(k) % depth]);
    std::fill(any.begin(), any.end(), std::uint8_t{0});
    for (const auto& layer : layers)
      for (std::size_t i = 0; i < layer_size; ++i) any[i] = static_cast<std::uint8_t>(any[i] | layer[i]);
    for (std::size_t i = 0; i < layer_size; ++i)
      if (any[i]) visit(k * static_cast<std::int64_t>(layer_size) + static_cast<std::int64_t>(i));
  }
}

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

void check_functions(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  {
    ProblemKind kind(problems, limit, "functions/active");
    std::size_t next = 0;
    bool differs = false;
    for_each_function(m, [&](std::int64_t number) {
      if (differs) return;
      if (next < m.active_functions.size() && m.active_functions[next] == number) {
        ++next;
        return;
      }
      differs = true;
      kind.add("entry {} is {}, expected {}: the functions whose support holds an active span, ascending", next,
               next < m.active_functions.size() ? fmt::to_string(m.active_functions[next]) : std::string("missing"),
               number);
    });
    if (!differs && next != m.active_functions.size())
      kind.add("entry {} is {}, but no further function has an active span in its support", next,
               m.active_functions[next]);
    if (!kind.empty()) return;
  }
  ProblemKind kind(problems, limit, "functions/mass_fraction");
  // The points reproduce moments to `tolerance` only, so a function that is full up to a hair may come out above one.
  const double largest = 1 + volume_rounding(m.grid) + moment_error(m.quadrature);
  Sum from_functions, from_points;
  for (std::size_t f = 0; f < m.mass_fraction.size(); ++f) {
    const double chi = m.mass_fraction[f];
    if (!(chi > 0 && chi <= largest))
      kind.add("function {} has mass fraction {}, expected a number above 0 and at most 1", m.active_functions[f], chi);
    from_functions.add(chi * integral_of(m.grid, m.active_functions[f]));
  }
  for (const double w : m.points.weights) from_points.add(w);
  // The functions sum to one everywhere.
  if (kind.empty() &&
      !(std::abs(from_functions.value() - from_points.value()) <= integral_tolerance * from_points.value()))
    kind.add("Σ mass fraction · ∫ N = {:.17g}, expected the sum of the weights {:.17g}", from_functions.value(),
             from_points.value());
}

} // namespace iga::detail
