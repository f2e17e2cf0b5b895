// The embedded surface tied to the grid: points with areas and normals per span, vertices with owning spans.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/trim.hpp"

namespace iga::prep {

/// Points exact to total degree 3 max(p) on every piece of the surface, positive weights; every piece and every vertex
/// is owned by an active span: one in a grid plane or in a snapped or dropped span goes to the neighbour on the
/// material side, its parameters clamped to that span's face. Σ weights per region = area of the region to rounding.
EmbeddedSurface make_embedded_surface(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming);

} // namespace iga::prep
