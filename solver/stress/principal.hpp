// Principal stresses.
#pragma once

#include "solver/mechanics/material.hpp"

namespace iga::solve {

/// Largest first. The largest shear stress is half of the first less the last.
Eigen::Vector3d principal_stresses(const Voigt& stress);

} // namespace iga::solve
