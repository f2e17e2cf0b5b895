// Rigid bodies as triangles, to be seen beside the bodies that they touch.
#pragma once

#include "solver/explicit/contact/rigid_body.hpp"

namespace iga::solve {

/// In the body's own frame. @param plane_size  side of the square that stands for a plane, length
TriangleMesh shape_mesh(const RigidShape& shape, double plane_size);

} // namespace iga::solve
