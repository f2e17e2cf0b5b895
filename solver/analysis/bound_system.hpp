// Stiffness of all bodies of a run with what holds them and what ties them to each other.
#pragma once

#include "solver/analysis/run_settings.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/mechanics/body_system.hpp"
#include "solver/supports/rigid_regions.hpp"
#include "solver/ties/tie.hpp"

namespace iga::solve {

struct BoundSystem {
  StiffnessMatrix K;                     ///< with the terms of supports and ties
  std::vector<SupportTerms> of_body;     ///< by body: its supports, in their order
  std::vector<std::size_t> support_body; ///< by support of the run: its body
  std::vector<RegionReport> regions;     ///< by support of the run
  std::vector<PreparedSpring> springs;   ///< of the run, in their order
  std::vector<PreparedMass> masses;      ///< likewise
  RigidRegions rigid_masses;             ///< of those that hold their region
  std::vector<PreparedTie> ties;
  std::vector<TieReport> tie_reports;
  ConstraintMatrix constraints; ///< of all bodies
  Eigen::VectorXd load;         ///< (num_unknowns): from prescribed values
  Eigen::VectorXd values;       ///< (constraints)
};

/// @throws InputError for supports and ties that find no surface, or several where one is meant
BoundSystem bind_system(const BodySystem& system, const RunSettings& run, Stopwatch& watch);

/// Springs and added masses of a run, for its report.
struct AttachedParts {
  struct OfSpring {
    RegionReport region;
    Spring spring;
    Point3 other{}; ///< centroid of the other end, where it has one; length
  };
  struct OfMass {
    RegionReport region;
    AddedMass added;
    Point3 centre{}; ///< of mass, length
  };
  std::vector<OfSpring> springs;
  std::vector<OfMass> masses;
  /// By body: triangles of its surface under springs and added masses, whose traction they make.
  std::vector<std::vector<std::int64_t>> triangles = {};
};
AttachedParts attached_parts(const BoundSystem& bound); ///< of as many bodies as bound.of_body
/// Warnings about what they act on.
std::vector<std::string> attached_warnings(const AttachedParts& parts);

/// Reactions of all supports in the order of the run. @param multipliers (constraints)
std::vector<Reaction> reactions(const BodySystem& system, const BoundSystem& bound, const Eigen::VectorXd& u,
                                const Eigen::VectorXd& multipliers);

} // namespace iga::solve
