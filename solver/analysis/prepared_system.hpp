// What all eigenvalue analyses start from: space, stiffness with its supports, mass.
#pragma once

#include "solver/analysis/run_settings.hpp"
#include "solver/mechanics/mass_operator.hpp"

namespace iga::solve {

struct PreparedSystem {
  std::unique_ptr<SolutionSpace> space;
  StiffnessMatrix K;
  MassOperator M;
  SupportTerms supports;
  std::vector<std::string> warnings;                   ///< of the space and the mass
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// The largest eigenfrequency is that of explicit dynamics, which knows no Lagrange multipliers.
/// @throws InputError where a support asks for them
void refuse_multipliers(const RunSettings& run);

PreparedSystem prepare_system(const RunSettings& run, const TrimmedModel& model);

} // namespace iga::solve
