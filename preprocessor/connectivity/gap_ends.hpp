// Where a gap ends inside the support of a B-spline: functions of lower continuity, so that the walls beside the gap
// move on their own up to its last span.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/connectivity/function_copies.hpp"

namespace iga::prep {

/// Coefficients of functions from unknowns.
struct GapEndUnknowns {
  Unknowns rows;            ///< without mass fractions, which need points; empty where no gap ends
  std::vector<double> full; ///< (n_u); ∫ of each unknown's function over all spans of its support, parameter³
};

/// Pieces that are to have functions of their own: (num_pieces), nonzero for those.
///
/// A copy that reaches around the end of a gap glues its walls over degree + 1 spans. Two pieces in the 2³ spans about
/// a vertex of the grid that no links within these spans join see a gap between them; they are glued where one copy
/// reaches both. Where the shortest way through links from one to the other is more than two steps longer than the way
/// across the gap, the gap is more than one span deep. Copies that glue across such a gap are what has to go: all
/// pieces that they glue, and the pieces linked with those that see such a copy, get functions of their own.
std::vector<std::uint8_t> find_gap_ends(const SplineGrid& grid, const std::vector<std::int64_t>& active,
                                        const PieceGraph& graph, const FunctionCopies& copies);

/// Gives the chosen pieces B-splines of their own, one set each, and makes the unknowns from which the coefficients
/// follow. In these pieces the solution is made of Bernstein functions (degree p, continuous across faces), one copy
/// for each connected component of the pieces in its support of at most 2³ spans. A copy that reaches a piece with
/// smooth functions follows them (Bézier extraction), so that the solution stays continuous and every field of the
/// smooth functions remains in the space: eigenvalues can only fall.
/// @param own     of find_gap_ends
/// @param copies  with the functions of all pieces; leaves with those of the chosen pieces replaced
GapEndUnknowns separate_gap_ends(const SplineGrid& grid, const std::vector<std::int64_t>& active,
                                 const PieceGraph& graph, const std::vector<std::uint8_t>& own, FunctionCopies& copies);

} // namespace iga::prep
