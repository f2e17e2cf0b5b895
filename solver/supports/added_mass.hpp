// Mass beside that of the part's material: points, mass spread over a surface, rigid bodies joined to a surface.
#pragma once

#include "solver/mechanics/loads.hpp"
#include "solver/mechanics/mass_operator.hpp"
#include "solver/space/places.hpp"

namespace iga::solve {

/// With `rigid` a body that moves with the average motion of a region (average_motion), and with `holds_region` keeps
/// the region from moving otherwise; without it mass that is spread evenly over a region, along lines, or sits at a
/// point, and moves with the part there.
struct AddedMass {
  std::string name;
  std::string body; ///< that it is joined to; empty: the only one that has such surface
  RegionChoice region;
  PlaceChoice place; ///< instead of a region
  double mass = 0;
  bool rigid = false;
  bool holds_region = false;    ///< of a rigid one: the region moves as a rigid body with it (RigidRegions)
  std::optional<Point3> centre; ///< of a rigid one, length; default: the region's centroid
  /// Of a rigid one, about its centre, along the part's axes; mass · length²
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// An added mass and what it is joined to.
struct PreparedMass {
  AddedMass added;
  std::size_t body = 0;
  SurfaceRegion region;
  Point3 centre{}; ///< of mass, length
  /// Rigid ones: W of the mass Wᵀ W, (rank × num_unknowns of the system). No rows otherwise.
  RowMatrix rows;
  /// Rigid ones: motion of the body at its centre, (6 × num_unknowns of the system). No rows otherwise.
  RowMatrix motion;
};

/// @throws InputError for a region without area or a place outside the part, naming the mass
std::vector<PreparedMass> prepare_masses(const BodySystem& system, std::span<const AddedMass> masses);

/// The mass of a run with what is added.
/// @throws InputError as make_mass, and for rigid bodies with another mass than the consistent one
MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       std::span<const PreparedMass> added);

/// Does the load act on masses: acceleration, turning?
bool acts_on_mass(LoadKind kind);
/// Force of an added mass under such a load: ∫ f(x) dm, of a rigid body its moment too (that of its centrifugal forces,
/// -ω × J ω, and -J α where it speeds up). (num_unknowns)
Eigen::VectorXd inertia_force(const BodySystem& system, const PreparedMass& mass, const Load& load);
/// What such a force adds to the stiffness as the part moves, of low rank for rigid bodies: its growth away from the
/// axis of turning (spin softening; of a rigid body the change of ½ ω² aᵀ J a with its orientation too), and the
/// turning of the arm between a rigid body's centre and its region.
void add_inertia_stiffness(const BodySystem& system, const PreparedMass& mass, const Load& load, StiffnessMatrix& L);

/// Axis of a centrifugal load, unit, the part's frame.
Eigen::Vector3d spin_axis(const Load& load);

} // namespace iga::solve
