// How far the two sides of a contact pair have moved against each other since a moment.
#pragma once

#include "solver/explicit/contact/moving_surface.hpp"

#include <vector>

namespace iga::solve {

/// The sides as they are now.
struct PairSides {
  const MovingSurface* first = nullptr;  ///< deformable
  const MovingSurface* second = nullptr; ///< a deformable surface, perhaps the first one, or a tool; null: closed form
  const Eigen::VectorXd* first_displacement = nullptr;
  const Eigen::VectorXd* second_displacement = nullptr; ///< null for rigid bodies
  const RigidState* rigid = nullptr;                    ///< second side, else null
  bool is_self() const { return first == second; }
};

class PairMotion {
 public:
  /// From now on. @param reach  a rigid body's distance from its centre to where it may touch, length
  /// @pre positions of all vertices are up to date
  void start(const PairSides& sides, double reach);
  /// Of any two points of the two sides against each other since start: at most this. Costs a pass over the nodes.
  double bound(const PairSides& sides) const;
  /// The same from the vertices' positions, much closer: of points that were no farther from each other than `near` at
  /// the start (in self-contact; else of any two). Bounds go on from there.
  /// In self-contact the motion is measured against the affine motion that fits it best, Δx = w + G (x - c) + r(x):
  /// |Δx_a - Δx_b| <= |r_a| + |r_b| + |G| |x_a - x_b|. A part that is crushed evenly does not come closer to itself.
  /// @pre positions of all vertices are up to date
  double measure(const PairSides& sides, double near);

 private:
  void keep(const PairSides& sides);

  double measured_ = 0; ///< at the last measurement; nodes and pose are those of then
  double reach_ = 0;
  Eigen::VectorXd first_displacement_, second_displacement_;
  Pose pose_;
  std::vector<Point3> first_, second_; ///< at the start, first_ in the frame of a rigid second side
};

} // namespace iga::solve
