// Bodies that share B-spline functions: they move as one, however the surface separates them.
#pragma once

#include "preprocessor/trim/trim.hpp"

namespace iga::prep {

struct JoinedBodies {
  std::int64_t bodies = 0; ///< closed shells that enclose material (cavities not counted)
  std::int64_t groups = 0; ///< sets of bodies that no function joins
};

/// Counts bodies and sets of bodies joined by functions whose support holds material of several.
/// Shells that share a vertex count as one body.
JoinedBodies find_joined_bodies(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming);

} // namespace iga::prep
