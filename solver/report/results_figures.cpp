#include "solver/report/results_figures.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

constexpr double sample_tolerance = 1e-9; // of the largest; coefficients of light functions may be far larger

// Largest distance of the points' positions, and of their displacements from Σ N c.
std::pair<double, double> differences(const StaticResult& statics, const TrimmedModel& m) {
  std::pair<double, double> worst{0, 0};
  std::array<std::vector<double>, 3> N;
  for (std::size_t d = 0; d < 3; ++d) N[d].resize(static_cast<std::size_t>(m.grid.degree()[d]) + 1);
  for (std::size_t c = 0; c < m.num_cells(); ++c) {
    const Index3 span = m.grid.span_index(m.cells.span[c]);
    for (auto q = static_cast<std::size_t>(m.points.offsets[c]); q < static_cast<std::size_t>(m.points.offsets[c + 1]);
         ++q) {
      Point3 u{}, displacement{};
      for (std::size_t d = 0; d < 3; ++d) {
        u[d] = m.points.parameters[3 * q + d];
        evaluate_basis(m.grid.knots(static_cast<int>(d)), span[d], u[d], N[d]);
      }
      const auto functions = m.functions_of(c);
      std::size_t place = 0;
      for (const double w : N[2])
        for (const double v : N[1])
          for (const double t : N[0]) {
            const auto f = static_cast<std::size_t>(functions[place++]);
            for (std::size_t d = 0; d < 3; ++d) displacement[d] += t * v * w * statics.displacement[3 * f + d];
          }
      const auto at = [q](const std::vector<double>& values) {
        return Point3{values[3 * q], values[3 * q + 1], values[3 * q + 2]};
      };
      worst.first = std::max(worst.first, norm(minus(at(statics.positions), m.grid.to_position(u))));
      if (!statics.points.displacement.empty())
        worst.second = std::max(worst.second, norm(minus(at(statics.points.displacement), displacement)));
    }
  }
  return worst;
}

} // namespace

std::vector<CheckFigure> measure_results(const Results& r, const TrimmedModel& m, const std::string& sha256) {
  const bool named = r.header.model_sha256 == sha256 ||
                     std::any_of(r.bodies.begin(), r.bodies.end(),
                                 [&](const BodyResult& body) { return body.model_sha256 == sha256; });
  std::vector<CheckFigure> rows{{"results that name another model (SHA-256)", named ? 0.0 : 1.0, 0}};
  if (!r.bodies.empty()) return rows;
  const bool same = r.active_functions == m.functions.number;
  rows.push_back({"results with other functions than the model's", same ? 0.0 : 1.0, 0});
  if (!r.statics) return rows;
  const std::size_t points = r.statics->positions.size() / 3, expected = m.points.weights.size();
  rows.push_back({"results: points more or fewer than the model's",
                  static_cast<double>(std::max(points, expected) - std::min(points, expected)), 0});
  if (!same || points != expected) return rows;
  const auto [position, displacement] = differences(*r.statics, m);
  const Point3 h = m.grid.span_size();
  double largest = 0;
  for (const double c : r.statics->displacement) largest = std::max(largest, std::abs(c));
  rows.push_back({"results: points elsewhere, over the span's diagonal", position / norm(h), sample_tolerance});
  if (!r.statics->points.displacement.empty())
    rows.push_back({"results: displacement at the points against Σ N c, of the largest c",
                    largest > 0 ? displacement / largest : displacement, sample_tolerance});
  return rows;
}

} // namespace iga::solve
