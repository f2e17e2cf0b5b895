// Mass beside that of the part's material: points, mass spread over a surface, rigid bodies joined to a surface.
#pragma once

#include "solver/mechanics/mass_operator.hpp"
#include "solver/space/places.hpp"

namespace iga::solve {

/// With `rigid` a body that moves with the average motion of a region (average_motion); without it mass that is spread
/// evenly over a region, along lines, or sits at a point, and moves with the part there.
struct AddedMass {
  std::string name;
  std::string body; ///< that it is joined to; empty: the only one that has such surface
  RegionChoice region;
  PlaceChoice place; ///< instead of a region
  double mass = 0;
  bool rigid = false;
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
};

/// @throws InputError for a region without area or a place outside the part, naming the mass
std::vector<PreparedMass> prepare_masses(const BodySystem& system, std::span<const AddedMass> masses);

/// The mass of a run with what is added.
/// @throws InputError as make_mass, and for rigid bodies with another mass than the consistent one
MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       std::span<const PreparedMass> added);

/// Force of an added mass under an acceleration field of gravity's kind: M a for a constant a. (num_unknowns)
/// @param acceleration  length/time², the part's axes
Eigen::VectorXd weight_of(const BodySystem& system, const PreparedMass& mass, const Point3& acceleration);

} // namespace iga::solve
