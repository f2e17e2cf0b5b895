// Which cell of a span a place belongs to, where the span holds several.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::solve {

/// The cell whose surface inside the span is nearest to a place: a place in the solid, or on its surface, and the
/// nearest surface within the convex span have nothing but the solid between them.
/// @param span  linear number; holds at least one cell
/// @param u     parameter of the place, in or near the closed span
std::size_t choose_cell(const TrimmedModel& model, std::int64_t span, const Point3& u);

} // namespace iga::solve
