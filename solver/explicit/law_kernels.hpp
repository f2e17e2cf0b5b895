// The kernel of each material law.
#pragma once

#include "solver/explicit/internal_forces.hpp"
#include "solver/explicit/laws/laws.hpp"

#include <functional>

namespace iga::solve {

/// Makes the internal forces of a space; the space's model must outlive them.
using MakeForces = std::function<std::unique_ptr<InternalForces>(const SolutionSpace&)>;

MakeForces forces_of(const Law& law, const KernelOptions& options = {});

} // namespace iga::solve
