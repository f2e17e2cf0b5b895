// Penalty method: β = C E / h on every span; the displacement misses its value by O(h / C). A line and a point give way
// by about force/(E length) and force/(E h) themselves: β = C E and C E h miss a share of 1 / C of that.
#include "solver/supports/support_rows.hpp"

#include <cmath>

namespace iga::solve {

double penalty_stiffness(const SolutionSpace& space, const ElasticMaterial& material, Extent extent) {
  const double E = effective_modulus(material), h = std::cbrt(space.model().grid.span_volume());
  return extent == Extent::Surface ? E / h : extent == Extent::Line ? E : E * h;
}

void penalty_parameters(const SolutionSpace& space, const ElasticMaterial& material,
                        std::span<PreparedSupport* const> prepared) {
  for (PreparedSupport* const p : prepared)
    p->beta.assign(p->region.cells.size(),
                   p->support.penalty_factor * penalty_stiffness(space, material, p->region.report.extent));
}

} // namespace iga::solve
