// Where separate bodies of a surface come closest to each other.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <optional>

namespace iga::solve {

struct SurfaceGap {
  double width = 0; ///< length; 0 where bodies touch
  Point3 from{}, to{};
};

/// The narrowest gap up to `reach` between pieces of the surface that share no vertex; distances through material (a
/// wall around a cavity) do not count. Nothing where all gaps are wider.
std::optional<SurfaceGap> narrowest_gap(const TriangleMesh& mesh, double reach);

} // namespace iga::solve
