// A bound of the largest eigenfrequency from the spans alone, as the explicit codes have always done.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/mechanics/mass_type.hpp"

namespace iga::solve {

struct ElementBound {
  double omega = 0;      ///< angular frequency, 1/time: no global one with the lumped mass lies above it
  std::int64_t span = 0; ///< the active span that sets it
  std::size_t body = 0;  ///< of a system, that it belongs to
};

/// max over spans of ω_max(K_e, M_Le), times √passes. Fried (1972): valid as global matrices are sums of spans' ones.
/// Interior spans under an exact generalised rule enter with their own Gauss points, under a reduced one with those of
/// its points that they own: any parting of the points gives a bound. Nothing where light functions are extended (the
/// masses of an extended span are no sums of positive ones), for the consistent mass, and where a function has
/// stiffness but no mass in some span.
std::optional<ElementBound> element_bound(const SolutionSpace& space, const ElasticMaterial& material, MassType mass);
/// The largest of all bodies; nothing where one of them has none.
std::optional<ElementBound> element_bound(const BodySystem& system, MassType mass);

} // namespace iga::solve
