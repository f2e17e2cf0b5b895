// The linear static state that loads bring a part into, and what it adds to the stiffness.
#pragma once

#include "solver/analysis/static_analysis.hpp"

#include <algorithm>

namespace iga::solve {

/// A state of stress about which a part vibrates or buckles.
struct Preload {
  std::vector<std::string> names; ///< of the loads and bolts that act in it
  std::vector<Load> loads;        ///< of them, the loads
  StaticSolution solution;        ///< fields at points are dropped by load_stiffness
  StiffnessMatrix stiffness;      ///< L: of its stress and of turning loads
  double largest_strain = 0;      ///< Frobenius norm, away from lines and points that loads and supports act on
  std::vector<std::string> warnings;
};

/// What of a run makes the preload.
struct PreloadChoice {
  std::vector<Load> loads;
  std::vector<Bolt> bolts = {};
  bool others = true; ///< temperatures and the values that supports prescribe act too
};
/// Everything that loads the part.
PreloadChoice all_of(const StaticSettings& statics);

/// Solves K u = f and assembles L = K_G(σ(u)) - Σ ω² M_⊥, by the stress that results files hold; M_⊥ is the mass across
/// the axis of a centrifugal load, whose force grows where the part moves away from the axis (spin softening). With
/// what springs and added masses bring (add_spring_stress, add_inertia_stiffness).
/// @param bound  the system that L belongs to
/// @throws InputError, NumericalError as run_static; InputError for what only static runs know: load cases, inertia
/// relief, loads that keep their region rigid
Preload make_preload(const RunSettings& run, const PreloadChoice& choice, const BodySystem& system,
                     const BoundSystem& bound);

/// Loads or bolts whose names are in the list, or those whose are not.
template <class Named>
std::vector<Named> chosen_by_name(const std::vector<Named>& all, std::span<const std::string> names, bool in_list) {
  std::vector<Named> chosen;
  for (const Named& one : all)
    if ((std::find(names.begin(), names.end(), one.name) != names.end()) == in_list) chosen.push_back(one);
  return chosen;
}

/// Sentences on what the linear theory of a preload leaves out: for reports.
std::vector<std::string> preload_notes(const RunSettings& run, const Preload& preload);

} // namespace iga::solve
