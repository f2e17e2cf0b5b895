// Springs: elastic foundations of surfaces, springs from a region, a line or a point to the ground or to another one.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/space/places.hpp"

namespace iga::solve {

/// To the ground: traction (on lines force/length, at points force) t = -D u. Between two ends: equal and opposite
/// forces on the ends' average motions, which rigid motions of both together leave without force.
struct Spring {
  std::string name;
  std::string body; ///< that it holds; empty: the only one that has such surface
  RegionChoice region;
  PlaceChoice place; ///< instead of a region
  /// Elastic foundation of a surface, along its normal and across it; force/length³.
  double normal = 0, tangential = 0;
  /// Instead: of all the region together, along the axes of `frame`; force/length.
  std::optional<Point3> total;
  Rotation frame = identity_rotation;
  /// The other end of a spring that does not stand on the ground.
  struct End {
    std::string body;
    RegionChoice region;
    PlaceChoice place;
  };
  std::optional<End> to;
  /// Between two ends: along the line from one centroid to the other; force/length. With `total` instead both ends are
  /// surface, and the spring sits halfway between their centroids.
  double axial = 0;
};

/// A spring and the region it acts on.
struct PreparedSpring {
  Spring spring;
  std::size_t body = 0;
  SurfaceRegion region;
  /// Of a spring between two ends: its energy is ½ |rows u|², the force on the first end -pull (rows u).
  std::size_t other_body = 0;
  SurfaceRegion other;
  RowMatrix rows;                                ///< (rank × num_unknowns of the system); none to the ground
  Eigen::Matrix<double, 3, Eigen::Dynamic> pull; ///< (3 × rank)
  bool is_grounded() const { return !spring.to; }
  /// D at a point with the outward unit normal n; force/length³, on lines /length², at points /length.
  Eigen::Matrix3d stiffness(const Point3& n) const;
};

/// @throws InputError for a region without area or a place outside the part, naming the spring
std::vector<PreparedSpring> prepare_springs(const BodySystem& system, std::span<const Spring> springs);
/// Adds ∫ N_i D N_j, local to a span, and springs between two ends as parts of low rank.
void add_springs(const BodySystem& system, std::span<const PreparedSpring> springs, StiffnessMatrix& K);

/// What the force of springs along the line between their ends adds to the stiffness where the line turns: N / L across
/// it, N the tension under u and L the distance of the ends. All other springs keep the directions of their forces.
/// @param u  (num_unknowns) of the linear static state
void add_spring_stress(const BodySystem& system, std::span<const PreparedSpring> springs, const Eigen::VectorXd& u,
                       StiffnessMatrix& L);

/// What a spring does to the part.
struct SpringForce {
  Point3 force{};    ///< on the part; of a spring between two ends, on the first one
  Point3 moment{};   ///< about the origin, force · length
  double energy = 0; ///< ½ ∫ u · D u, force · length
};
std::vector<SpringForce> spring_forces(const BodySystem& system, std::span<const PreparedSpring> springs,
                                       const Eigen::VectorXd& u);

} // namespace iga::solve
