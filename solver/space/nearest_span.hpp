// Which span, and which of its cells, a point belongs to: the one that holds it, the one on the side of the material
// where it lies in a grid plane, the nearest one where its own span holds no material.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::solve {

struct NearestSpan {
  std::int64_t cell = -1;
  double distance = 0; ///< of the point from the closed span, in spans; 0 where the span holds it
  Point3 parameter{};  ///< of the point, moved into the closed span
};

/// @param u        parameter of the point
/// @param outward  outward normal where the point lies on the surface (part's frame, any length), zero elsewhere:
///                 of spans that hold the point alike, the one behind the surface is taken. Among the cells of a span
///                 choose_cell decides
/// @pre the model has cells
NearestSpan nearest_span(const TrimmedModel& model, const Point3& u, const Point3& outward);

} // namespace iga::solve
