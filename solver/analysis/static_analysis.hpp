// Linear statics: K u = f on supports, with reactions, energies and stresses.
#pragma once

#include "format/model/results.hpp"
#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/analysis/solver_choice.hpp"
#include "solver/supports/boundary.hpp"
#include "solver/supports/read_supports.hpp"
#include "solver/supports/rigid_regions.hpp"
#include "solver/ties/tie.hpp"

namespace iga::solve {

/// How a free mechanical body answers to the loads: it accelerates as a rigid one.
struct RigidAcceleration {
  std::vector<std::string> bodies; ///< of the run that it consists of; none where there is one
  double mass = 0;
  Point3 centre{};                          ///< of mass, length
  Point3 acceleration{};                    ///< of the centre, length/time²
  Point3 angular{};                         ///< radians/time²
  Point3 inertia_force{}, inertia_moment{}; ///< that balance the loads; the moment about the origin
};

/// The temperature of one body.
struct TemperatureReport {
  std::string body;   ///< empty where there is one
  std::string source; ///< "uniform", "formula 20 + 3*x", …
  double least = 0, most = 0, reference = 0;
  double factor = 1; ///< of the thermal strain in this case
};

/// What became of a bolt.
struct BoltReport {
  std::string name;
  std::string body;      ///< empty where there is one
  double preload = 0;    ///< that was asked for
  double factor = 1;     ///< of the shortening in this case
  double section = 0;    ///< of the shank, length²
  double shortening = 0; ///< that brings the preload, length
  double force = 0;      ///< tension of the shank under all that acts in this case
};

/// Fields of one of several bodies.
struct StaticBody {
  std::vector<double> displacement; ///< (n_f × 3): coefficients of all active functions, length
  std::vector<double> positions;    ///< (num_points × 3) of the model's quadrature points, length
  FieldSamples points;              ///< one step, at the model's quadrature points
  FieldSamples surface;             ///< one step, at model.surface.quadrature
};

/// The largest value of a field and where it is.
struct LargestValue {
  double value = 0;
  Point3 at{};          ///< length
  std::size_t body = 0; ///< of the system
};

/// The solution and what a user checks first.
struct StaticSolution {
  /// The bodies with the initial strains of this solution: stresses of `unknowns` are those of *its* materials, not of
  /// the materials that the analysis was called with.
  BodySystem system;
  std::string case_name;                 ///< empty where the run has no [[case]]
  std::vector<double> factors;           ///< by load
  Eigen::VectorXd unknowns;              ///< (num_unknowns) of the system
  Eigen::VectorXd multipliers;           ///< (constraints)
  StaticResult result;                   ///< as the results file holds it; of several bodies without their fields
  std::vector<StaticBody> bodies;        ///< fields of several bodies; none where there is one
  std::vector<RegionReport> regions;     ///< of the supports
  std::vector<LoadReport> loads;         ///< resultants about the origin
  std::vector<Reaction> reactions;       ///< about the origin
  std::vector<std::string> probe_bodies; ///< by probe; empty names where there is one body
  std::vector<std::pair<std::size_t, RegionMotion>> motions; ///< of rigid regions, with the numbers of their loads
  std::vector<RigidAcceleration> relief;                     ///< by mechanical body, under inertia relief
  std::vector<TemperatureReport> temperatures;
  std::vector<BoltReport> bolts;
  AttachedParts attached;                 ///< springs and added masses
  std::vector<SpringForce> spring_forces; ///< about the origin
  std::vector<TieReport> ties;
  std::vector<TieForce> tie_forces;  ///< about the origin
  FieldSamples surface;              ///< one step, at model.surface.quadrature; of one body
  LargestValue largest_displacement; ///< length, over quadrature points of volume and surface
  LargestValue largest_von_mises;    ///< force/length², over the same points
  /// Estimated a(e, e) of the error e of the displacements, force · length; none where it cannot be told.
  std::optional<double> energy_error;
  std::string no_energy_error;              ///< why not
  double residual = 0;                      ///< ‖f - K u - Cᵀ λ‖ / ‖f‖ after one step of refinement
  Point3 force_balance{}, moment_balance{}; ///< Σ loads + Σ reactions + Σ forces of springs
  std::vector<std::string> warnings;        ///< of supports and loads on lines and at points
  FactorCost cost;                          ///< of the factor, or the bytes of multigrid's levels
  SolverReport solver;
  std::int64_t num_constraints = 0;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// Name of the line or point that supports or loads act on and that a place lies too near to (RegionReport::reach) for
/// its stress to be read: "support 'edge'"; nothing where there is none.
/// @param body  name of the place's body; empty where there is one body
std::optional<std::string> singular_place_near(const StaticSolution& solution, const std::string& body,
                                               const Point3& x);

/// Estimated errors, relative: of the strain energy, and of strains and stresses in the mean over the part (energy
/// norm).
struct StaticErrors {
  double strain_energy = 0, energy_norm = 0;
};
/// None where there is no estimate, or nothing to relate it to.
std::optional<StaticErrors> relative_errors(const StaticSolution& solution);

/// What is missing between the two sides of the energy balance (StaticResult), relative to the larger one.
double energy_defect(const StaticResult& result);

/// One solution for each [[case]], with one factorisation; one in all where the run has none. Stages that cases share
/// are timed in the first one.
std::vector<StaticSolution> run_static_cases(const RunSettings& run, const StaticSettings& settings,
                                             const BodySystem& system);

/// The only one. @pre the settings have at most one case
/// @throws InputError for regions without area, points outside the part, and rigid motions that no support resists
/// @throws NumericalError where the system is singular all the same
StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const BodySystem& system);
/// Of one body of the run's material.
StaticSolution run_static(const RunSettings& run, const StaticSettings& settings, const SolutionSpace& space);

} // namespace iga::solve
