// Loads and probes of a run on a system of bodies: which body each belongs to, and what it does there.
#pragma once

#include "solver/analysis/field_errors.hpp"
#include "solver/output/recover.hpp"
#include "solver/supports/added_mass.hpp"

namespace iga::solve {

/// One load of the run on the bodies that it acts on.
struct SystemLoad {
  Eigen::VectorXd load; ///< (num_unknowns)
  LoadReport report;
  std::vector<std::size_t> bodies;
  std::vector<BodyLoads> of_body; ///< by body of the system
};

/// @throws InputError for regions without area, points outside the part, and places that several bodies have
SystemLoad assemble_load(const BodySystem& system, const Load& load);
/// Adds what the load does to masses on the bodies that it acts on: theirs under acceleration and turning.
void add_masses(const BodySystem& system, std::span<const PreparedMass> masses, const Load& load, SystemLoad& all);
/// By load of the run.
std::vector<SystemLoad> assemble_loads(const BodySystem& system, std::span<const Load> loads);

/// Where a probe lies.
struct LocatedProbe {
  std::size_t body = 0;
  LocatedPoint place;
};

/// Found before anything is computed. @throws InputError naming a probe outside the part, or in several bodies
std::vector<LocatedProbe> locate_probes(const BodySystem& system, std::span<const Probe> probes);

} // namespace iga::solve
