// The shift of the grid within one span that leaves the fewest light functions: functions with so little material in
// their support that their coefficients hardly carry mass (numerics: light control points).
#pragma once

#include "preprocessor/trim/make_grid.hpp"
#include "preprocessor/trim/trim.hpp"

#include <functional>

namespace iga::prep {

/// A function is light where less than this share of its full mass lies in the solid.
constexpr double light_mass_fraction = 0.05;

/// Number of functions with material whose mass fraction ∫_Ω N dV / ∫ N dV is below `light_mass_fraction`. Over a
/// trimmed span ∫_Ω N is taken as volume fraction × ∫ N over the span: exact for interior spans, and needs no
/// quadrature. Works layer by layer: memory for p + 1 layers of functions.
std::int64_t light_function_count(const SplineGrid& grid, const Trimming& trimming);

struct OffsetSearch {
  Point3 offset{};               ///< spans, 0 … 1; see place_grid
  std::int64_t light_before = 0; ///< with the part centred
  std::int64_t light_after = 0;
  int evaluations = 0; ///< trimmed grids
};

/// DIRECT-L (Gablonsky and Kelley 2001) looks over the unit cube of offsets, subplex (Rowan 1990) then follows the best
/// one, down to faces that meet grid planes exactly; both are NLopt's, need no derivatives (the count is piecewise
/// constant) and give the same result in every run. The centred grid stays where no shift beats it.
/// @param progress   called after every evaluation with how many are done of how many at most
/// @param cancelled  true ends the search; the best offset so far is returned
OffsetSearch optimise_offset(const GridFrame& frame, const TriangleMesh& mesh, const TrimOptions& options,
                             const std::function<void(std::int64_t, std::int64_t)>& progress,
                             const std::function<bool()>& cancelled);

} // namespace iga::prep
