// What load cases do at most at each vertex of a surface, and which of them.
#pragma once

#include "format/model/results.hpp"

namespace iga {

/// Largest values over the steps of a surface, (num_vertices) each; of equal ones the first case counts.
struct SurfaceEnvelope {
  std::vector<double> displacement;      ///< length of the vector, length
  std::vector<double> displacement_case; ///< from 1
  std::vector<double> von_mises;         ///< force/length²
  std::vector<double> von_mises_case;    ///< from 1
};

/// @pre the surface has displacement and von Mises stress
SurfaceEnvelope surface_envelope(const SurfaceResult& surface);

} // namespace iga
