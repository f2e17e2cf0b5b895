// Where a body begins: its model, moved as a rigid body before the run.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::solve {

/// x → about + R (x - about) + shift
struct Placement {
  Rotation R = identity_rotation;
  Point3 about{}, shift{}; ///< length

  bool operator==(const Placement&) const = default;
  Point3 turned(const Point3& direction) const;
  Point3 moved(const Point3& x) const;
};

/// Right-handed, `angle` in radians. @pre axis has length 1
Rotation rotation_about(const Point3& axis, double angle);

/// Moves grid, points and surface. Weights, states and functions stay as they are; parameters follow the grid's box.
/// @return a sound model, equal to that of the moved part in the moved grid up to rounding
TrimmedModel placed(TrimmedModel model, const Placement& placement);

} // namespace iga::solve
