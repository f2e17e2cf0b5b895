// Linear statics: K u = f on supports, with reactions, energies and stresses.
#pragma once

#include "format/model/results.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/supports/boundary.hpp"
#include "solver/supports/read_supports.hpp"
#include "solver/supports/rigid_regions.hpp"

namespace iga::solve {

/// The solution and what a user checks first.
struct StaticSolution {
  Eigen::VectorXd unknowns;                                 ///< (num_unknowns) of the space
  Eigen::VectorXd multipliers;                              ///< (constraints)
  StaticResult result;                                      ///< as the results file holds it
  std::vector<RegionReport> regions;                        ///< of the supports
  std::vector<LoadReport> loads;                            ///< resultants about the origin
  std::vector<Reaction> reactions;                          ///< about the origin
  std::vector<std::pair<std::size_t, RigidMotion>> motions; ///< of rigid regions, with the numbers of their loads
  FieldSamples surface;                                     ///< one step, at model.surface.quadrature
  double largest_displacement = 0;                          ///< length, over quadrature points of volume and surface
  Point3 largest_displacement_at{};                         ///< length
  double largest_von_mises = 0;                             ///< force/length², over the same points
  Point3 largest_von_mises_at{};                            ///< length
  double residual = 0;                      ///< ‖f - K u - Cᵀ λ‖ / ‖f‖ after one step of refinement
  Point3 force_balance{}, moment_balance{}; ///< Σ loads + Σ reactions
  std::vector<std::string> warnings;        ///< of supports and loads on lines and at points
  FactorCost cost;
  std::int64_t num_constraints = 0;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// Name of the line or point that supports or loads act on and that a place lies too near to, singular_reach, for its
/// stress to be read: "support 'edge'"; nothing where there is none.
std::optional<std::string> singular_place_near(const StaticSolution& solution, const SplineGrid& grid, const Point3& x);

/// What is missing between the two sides of the energy balance (StaticResult), relative to the larger one.
double energy_defect(const StaticResult& result);

/// @throws InputError for regions without area, points outside the part, and rigid motions that no support resists
/// @throws NumericalError where the system is singular all the same
StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const SolutionSpace& space);

} // namespace iga::solve
