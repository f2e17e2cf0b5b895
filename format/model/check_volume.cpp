// Quadrature points against states, fractions and the part's volume.
#include "format/model/model_check.hpp"

#include <algorithm>
#include <cmath>

namespace iga::detail {

namespace {

// "cell 7 of span 12": what there is to be found in the file.
std::string name_of(const TrimmedModel& m, std::size_t cell) {
  return fmt::format("cell {} of span {}", cell, m.cells.span[cell]);
}

SpanState state_of(const TrimmedModel& m, std::size_t a) {
  return static_cast<SpanState>(m.cells.state[a]);
}

void check_fractions(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "cells/volume_fraction");
  const double rounding = volume_rounding(m.grid);
  // A snapped span keeps its exact fraction: all of its surface lies within the sliver depth of its six faces.
  const double least_interior = 1 - 6 * m.quadrature.sliver_tolerance - rounding;
  const bool leaks = m.surface.accepted_leak > 0;
  double whole = 0; // of the span's cells so far
  for (std::size_t a = 0; a < m.cells.span.size(); ++a) {
    const double f = m.cells.volume_fraction[a];
    if (!(f >= -rounding && f <= 1 + rounding) && !(leaks && std::isfinite(f)))
      kind.add("{} has fraction {}, expected 0 … 1", name_of(m, a), f);
    else if (state_of(m, a) == SpanState::Interior && !(f >= least_interior) && !leaks)
      kind.add("interior {} has fraction {}, expected 1 to the sliver tolerance", name_of(m, a), f);
    whole = a > 0 && m.cells.span[a] == m.cells.span[a - 1] ? whole + f : f;
    if (!(whole <= 1 + rounding) && f <= 1 + rounding && !leaks)
      kind.add("the cells of span {} have fractions that sum to {}, expected at most 1", m.cells.span[a], whole);
  }
}

void check_residuals(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "quadrature/residual");
  double worst = 0;
  for (std::size_t a = 0; a < m.cells.span.size(); ++a) {
    const double r = m.points.residual[a];
    if (!(r >= 0 && r <= m.quadrature.tolerance))
      kind.add("{} has residual {}, expected 0 … tolerance {}", name_of(m, a), r, m.quadrature.tolerance);
    else if (state_of(m, a) == SpanState::Interior && r != 0)
      kind.add("interior {} has residual {}, expected 0", name_of(m, a), r);
    worst = std::max(worst, r);
  }
  if (kind.empty() && m.quadrature.max_residual != worst)
    kind.add("attribute max_residual is {}, the largest residual is {}", m.quadrature.max_residual, worst);
}

bool info_fits(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind kind(problems, limit, "quadrature attributes");
  const auto& q = m.quadrature;
  const auto range = [&](const char* name, double value, bool good, const char* expected) {
    if (!std::isfinite(value) || !good) kind.add("{} is {}, expected {}", name, value, expected);
  };
  range("part_volume", q.part_volume, q.part_volume > 0, "a positive volume");
  range("snapped_volume", q.snapped_volume, true, "a finite volume");
  range("dropped_volume", q.dropped_volume, q.dropped_volume >= 0, "a volume of at least 0");
  range("tolerance", q.tolerance, q.tolerance > 0, "a positive number");
  range("max_residual", q.max_residual, q.max_residual >= 0, "a number of at least 0");
  range("sliver_tolerance", q.sliver_tolerance, q.sliver_tolerance >= 0 && q.sliver_tolerance < 0.5, "0 … 0.5");
  range("min_fraction", q.min_fraction, q.min_fraction >= 0 && q.min_fraction < 1, "0 … 1");
  range("accepted_leak of /surface", m.surface.accepted_leak, m.surface.accepted_leak >= 0, "a number of at least 0");
  if (m.surface.bodies < 0) kind.add("bodies of /surface is {}, expected a number of at least 1", m.surface.bodies);
  if (q.interior_rule != "gauss" && q.interior_rule != "ggq" && q.interior_rule != "ggq-reduced" &&
      q.interior_rule != "ggq-reduced2")
    kind.add("interior_rule is '{}', expected gauss, ggq, ggq-reduced or ggq-reduced2", q.interior_rule);
  if (q.trimmed_rule != "nnls" && q.trimmed_rule != "minimal")
    kind.add("trimmed_rule is '{}', expected nnls or minimal", q.trimmed_rule);
  if (q.surface_rule != "exact" && q.surface_rule != "reduced")
    kind.add("surface_rule is '{}', expected exact or reduced", q.surface_rule);
  for (const int d : q.moment_degree)
    if (d < 0 || d > 2 * max_degree) kind.add("moment_degree holds {}, expected 0 … {}", d, 2 * max_degree);
  if (q.snapped_spans < 0 || q.dropped_spans < 0)
    kind.add("snapped_spans is {} and dropped_spans {}, expected counts", q.snapped_spans, q.dropped_spans);
  return kind.empty();
}

} // namespace

double moment_error(const QuadratureInfo& info) {
  double num_moments = 1;
  for (const int d : info.moment_degree) num_moments *= d + 1;
  return info.tolerance * std::sqrt(num_moments);
}

void check_volume(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  const bool info = info_fits(m, limit, problems);
  if (info) {
    check_fractions(m, limit, problems);
    check_residuals(m, limit, problems);
  }
  {
    ProblemKind kind(problems, limit, "quadrature/offsets");
    check_offsets(m.points.offsets, m.points.weights.size(), kind);
    if (!kind.empty()) return;
  }
  ProblemKind owns(problems, limit, "quadrature/offsets against cells/state");
  ProblemKind inside(problems, limit, "quadrature/parameters");
  ProblemKind weight(problems, limit, "quadrature/weights");
  ProblemKind volume(problems, limit, "volume of a trimmed cell");
  ProblemKind total(problems, limit, "volume");
  const Point3 rounding = parameter_rounding(m.grid);
  const double span_volume = m.grid.span_volume(), span_rounding = volume_rounding(m.grid);
  const double fit = moment_error(m.quadrature);

  Sum all, interior;
  std::int64_t num_interior = 0;
  for (std::size_t a = 0; a < m.cells.span.size(); ++a) {
    const auto first = static_cast<std::size_t>(m.points.offsets[a]),
               last = static_cast<std::size_t>(m.points.offsets[a + 1]);
    const bool trimmed = state_of(m, a) == SpanState::Trimmed;
    if (first == last && (trimmed || m.quadrature.interior_rule == "gauss"))
      owns.add("{} {} owns no point", trimmed ? "trimmed" : "interior", name_of(m, a));
    const Index3 ijk = m.grid.span_index(m.cells.span[a]);
    Sum own;
    for (std::size_t q = first; q < last; ++q) {
      const double* u = &m.points.parameters[3 * q];
      if (!in_closed_span(m.grid, ijk, u, rounding))
        inside.add("point {} ({}, {}, {}) of cell {} lies outside its span {}", q, u[0], u[1], u[2], a,
                   m.cells.span[a]);
      const double w = m.points.weights[q];
      if (!(w > 0 && std::isfinite(w))) weight.add("point {} has weight {}, expected a positive number", q, w);
      own.add(w);
    }
    all.add(own.value());
    if (trimmed) {
      const double expected = m.cells.volume_fraction[a] * span_volume;
      if (info && !(std::abs(own.value() - expected) <= fit * std::abs(expected) + span_rounding * span_volume))
        volume.add("{} has weights that sum to {:.17g}, expected fraction · span volume = {:.17g}", name_of(m, a),
                   own.value(), expected);
    } else {
      ++num_interior;
      interior.add(own.value());
    }
  }
  const double expected_interior = static_cast<double>(num_interior) * span_volume;
  if (!(std::abs(interior.value() - expected_interior) <= span_rounding * expected_interior))
    total.add("weights of the interior cells sum to {:.17g}, expected {} · span volume = {:.17g}", interior.value(),
              num_interior, expected_interior);
  const auto& q = m.quadrature;
  const double expected = q.part_volume + q.snapped_volume - q.dropped_volume;
  if (info && !(std::abs(all.value() - expected) <= integral_tolerance * q.part_volume))
    total.add("all weights sum to {:.17g}, expected part_volume + snapped_volume - dropped_volume = {:.17g}",
              all.value(), expected);
}

} // namespace iga::detail
