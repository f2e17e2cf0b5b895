// All material laws of `igasolve explicit`.
#pragma once

#include "solver/explicit/laws/crushable_foam.hpp"
#include "solver/explicit/laws/linear_elastic.hpp"
#include "solver/explicit/laws/neo_hookean.hpp"

#include <variant>

namespace iga::solve {

/// One law per body: std::visit once per body and step, so that the kernel is compiled for each law.
using Law = std::variant<LinearElastic, NeoHookean, CrushableFoam>;

/// Elastic constants of the untouched material, C in force/length² at F = I: what the Lanczos estimate of the first
/// time step works with.
inline ElasticMaterial small_strain(const Law& law) {
  return std::visit([](const auto& l) { return ElasticMaterial(l.small_strain()); }, law);
}

} // namespace iga::solve
