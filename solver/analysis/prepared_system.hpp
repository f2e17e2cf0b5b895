// What all eigenvalue analyses start from: spaces, stiffness with supports and ties, mass.
#pragma once

#include "solver/analysis/bound_system.hpp"
#include "solver/mechanics/mass_operator.hpp"

namespace iga::solve {

struct PreparedSystem {
  BodySystem bodies;
  BoundSystem bound;
  MassOperator M;
  std::vector<std::string> warnings;                   ///< of the spaces and the mass
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// The largest eigenfrequency is that of explicit dynamics, which knows no Lagrange multipliers.
/// @throws InputError where a support asks for them
void refuse_multipliers(const RunSettings& run);

/// The bodies of a run and their spaces. @param models  placed, as many as bodies_of(run); must outlive the system
BodySystem make_system(const RunSettings& run, std::span<const TrimmedModel> models);
/// What the spaces warn of, with the bodies' names.
std::vector<std::string> space_warnings(const BodySystem& system);

PreparedSystem prepare_system(const RunSettings& run, std::span<const TrimmedModel> models);

} // namespace iga::solve
