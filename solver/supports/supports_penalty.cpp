// Penalty method: β = C E / h on every span; the displacement misses its value by O(h / C).
#include "solver/supports/support_rows.hpp"

#include <cmath>

namespace iga::solve {

void penalty_parameters(const SolutionSpace& space, const ElasticMaterial& material,
                        std::span<PreparedSupport* const> prepared) {
  const double stiffness = effective_modulus(material) / std::cbrt(space.model().grid.span_volume());
  for (PreparedSupport* const p : prepared)
    p->beta.assign(p->region.cells.size(), p->support.penalty_factor * stiffness);
}

} // namespace iga::solve
