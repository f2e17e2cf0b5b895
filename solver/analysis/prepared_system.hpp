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

/// What every eigenvalue analysis reports of its system.
struct SystemOutcome {
  BodySystem system; ///< coefficients belong to its spaces; lives no longer than the models
  double mass = 0;   ///< total, as discretised
  std::int64_t unknowns = 0;
  std::vector<RegionReport> regions; ///< of the supports
  std::vector<TieReport> ties;
  AttachedParts attached;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};
/// Takes all but the matrices out of a prepared system.
void hand_over(PreparedSystem& prepared, SystemOutcome& outcome);

/// The largest eigenfrequency is that of explicit dynamics, which knows no Lagrange multipliers.
/// @throws InputError where a support asks for them
void refuse_multipliers(const RunSettings& run);

/// The bodies of a run and their spaces. @param models  placed, as many as bodies_of(run); must outlive the system
BodySystem make_system(const RunSettings& run, std::span<const TrimmedModel> models);
/// What the spaces warn of, with the bodies' names.
std::vector<std::string> space_warnings(const BodySystem& system);

PreparedSystem prepare_system(const RunSettings& run, std::span<const TrimmedModel> models);

} // namespace iga::solve
