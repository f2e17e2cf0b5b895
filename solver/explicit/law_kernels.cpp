#include "solver/explicit/law_kernels.hpp"

#include "solver/explicit/span_kernel.hpp"

namespace iga::solve {

MakeForces forces_of(const Law& law, const KernelOptions& options) {
  return [law, options](const SolutionSpace& space) {
    return std::visit([&](const auto& own) { return make_internal_forces(space, own, options); }, law);
  };
}

} // namespace iga::solve
