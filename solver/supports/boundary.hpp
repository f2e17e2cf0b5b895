// Supports on the embedded surface: prescribed displacements imposed weakly by one of three methods.
#pragma once

#include "solver/linalg/linear_solver.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/space/cylinder.hpp"
#include "solver/space/places.hpp"
#include "solver/space/surface_region.hpp"

namespace iga::solve {

enum class SupportMethod { Nitsche, Penalty, Lagrange };

/// Prescribed displacement components on a region, in the frame whose columns are `frame` (default: the part's axes).
/// Component d of the prescribed displacement is value[d] + gradient[d] · x, x in the part's axes (length).
/// On a line or at a point (`place`) it is imposed by the penalty method.
struct Support {
  std::string name;
  std::string body; ///< that it holds; empty: the only one that has such surface
  RegionChoice region;
  PlaceChoice place; ///< instead of a region
  std::array<bool, 3> fixed{true, true, true};
  /// Instead of `fixed`: the component along the surface's own normal alone, point by point (symmetry plane,
  /// frictionless guide); it is prescribed to be value[0] (positive: outward).
  bool along_normal = false;
  /// Instead, on a cylindrical region: the component away from the axis, and with `axial` the one along it; the part
  /// may turn about the axis. The component away from the axis is prescribed to be value[0].
  bool radial = false, axial = false;
  Point3 value{};                   ///< length, in `frame`; constant part
  std::array<Point3, 3> gradient{}; ///< no unit; row d belongs to component d of `frame`
  Rotation frame = identity_rotation;
  SupportMethod method = SupportMethod::Nitsche;
  double penalty_factor = 1e3; ///< C in beta = C E / h, for the penalty method; on lines C E, at points C E h
};

/// One support with the region it found, and what its method fixed for it.
struct PreparedSupport {
  Support support;
  SurfaceRegion region;
  Cylinder cylinder; ///< of a radial support
  std::vector<double>
      beta; ///< (region.cells), force/length³ (on lines /length², at points /length); Nitsche and penalty
  std::int64_t first_constraint = 0; ///< its rows of the constraint matrix; Lagrange
  std::int64_t num_constraints = 0;
};

/// What supports add to a system beyond the stiffness matrix itself.
struct SupportTerms {
  Eigen::VectorXd load;         ///< (num_unknowns): right-hand side from prescribed values
  ConstraintMatrix constraints; ///< Lagrange multipliers: C u = values; no rows where none is asked for
  Eigen::VectorXd values;       ///< (constraints)
  std::vector<RegionReport> regions;
  std::vector<PreparedSupport> prepared; ///< for the reactions
};

/// Adds the supports' stiffness to K (same sparsity: all terms are local to a span) and returns the rest.
/// The result is positive definite without constraints where the supports hold the part (free_rigid_motions in
/// support_check.hpp).
/// @param tied        surfaces of the body that draw on the same strain energy as Nitsche's supports; they get their β
/// @param first_node  of the body in a K of several
/// @throws InputError for a region without area or a symmetry frame without directions, naming the support
SupportTerms apply_supports(const SolutionSpace& space, const ElasticMaterial& material,
                            std::span<const Support> supports, StiffnessMatrix& K,
                            std::span<PreparedSupport* const> tied = {}, std::int64_t first_node = 0);

/// What a material's initial strain ε₀ adds to the right-hand side through supports: -∫ (e·C ε₀ n)(e·v) dA, since the
/// traction of Nitsche's method is that of σ = C (ε - ε₀). Zero with the other methods and without ε₀. (num_unknowns)
Eigen::VectorXd initial_strain_load(const SolutionSpace& space, const ElasticMaterial& material,
                                    const SupportTerms& terms);

/// Warnings about what supports act on.
std::vector<std::string> region_warnings(std::span<const RegionReport> supports);

/// Force of a support on the part and its moment about the origin.
struct Reaction {
  std::string name;
  Point3 force{};  ///< force, the part's frame
  Point3 moment{}; ///< force · length
  double work = 0; ///< ½ ∫ t · u_D dA: work of the support's traction on its prescribed displacement
  /// What a weakly imposed displacement leaves open, u - u_D along the fixed directions, takes part in the energies:
  /// strain energy + penalty_energy = external work + work + gap_work. Zero with multipliers.
  /// ∫ (σ n) · (u - u_D) dA with Nitsche's method, zero with the penalty method; under an initial strain σ is the mean
  /// of C (ε - ε₀) and C ε.
  double gap_work = 0;
  double penalty_energy = 0; ///< ½ ∫ β |u - u_D|² dA
};

/// Reactions of all supports, each by its method's own consistent traction: they balance the loads to rounding. The
/// material's initial strain counts.
/// @param[in] u            (num_unknowns)
/// @param[in] multipliers  (constraints), as solved with [K Cᵀ; C 0]
std::vector<Reaction> reactions(const SolutionSpace& space, const ElasticMaterial& material, const SupportTerms& terms,
                                const Eigen::VectorXd& u, const Eigen::VectorXd& multipliers);

} // namespace iga::solve
